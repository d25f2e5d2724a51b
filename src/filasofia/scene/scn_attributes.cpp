#include "filasofia/scene/scn_attributes.h"

#include "filasofia/core/suggestion.h"
#include "filasofia/core/word.h"
#include "filasofia/scene/scn_tissue.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace filasofia::scene {

const std::vector<std::string_view> kCollision = {"TriangleCollisionModel", "LineCollisionModel", "PointCollisionModel",
                                                  "SphereCollisionModel"};

namespace {

using Words = std::vector<std::string_view>;

/// What a scene needs in SOFA and not here.
const Words kSilent = {"RequiredPlugin",
                       "DefaultAnimationLoop",
                       "DefaultVisualManagerLoop",
                       "FreeMotionAnimationLoop",
                       "VisualStyle",
                       "BruteForceBroadPhase",
                       "BVHNarrowPhase",
                       "ParallelBruteForceBroadPhase",
                       "ParallelBVHNarrowPhase",
                       "TaskSchedulerSettings",
                       "ViewerSetting",
                       "DiscreteIntersection",
                       "GenericConstraintSolver",
                       "BlockGaussSeidelConstraintSolver",
                       "LCPConstraintSolver",
                       "NNCGConstraintSolver",
                       "CGLinearSolver",
                       "PCGLinearSolver",
                       "SparseLDLSolver",
                       "EigenSimplicialLDLT",
                       "AsyncSparseLDLSolver",
                       "CholeskySolver",
                       "BTDLinearSolver",
                       "MatrixLinearSystem",
                       "BackgroundSetting",
                       "LightManager",
                       "VisualGrid",
                       "OglSceneFrame",
                       "LineAxis",
                       "InteractiveCamera",
                       "ConstraintAttachButtonSetting",
                       "AttachBodyButtonSetting"};

/// What is read of a node besides what makes its tissue.
const Words kPlain = {"MechanicalObject",
                      "BoxROI",
                      "BoxConstraint",
                      "OglModel",
                      "RestShapeSpringsForceField",
                      "ConstantForceField",
                      "RegularGridTopology",
                      "CollisionPipeline",
                      "DefaultPipeline",
                      "CollisionResponse",
                      "DefaultContactManager",
                      "MinProximityIntersection",
                      "LocalMinDistance",
                      "NewProximityIntersection"};

Words allOf(std::initializer_list<const Words*> lists)
{
    Words all;
    for (const Words* each : lists) all.insert(all.end(), each->begin(), each->end());
    return all;
}

/// The tags of the components that are read, but those that are known by their endings.
const Words& readTags()
{
    static const Words tags =
        allOf({&kPlain, &kElastic, &kHyperelastic, &kSprings, &kMasses, &kImplicit, &kExplicit, &kFixed, &kCollision});
    return tags;
}

/// An attribute that changes nothing if each of its words is this one.
struct AtRest {
    std::string_view name;
    double value;
};

/// What the components of some tags may say. What draws, prints or counts is in no list: it has its beginnings below.
struct Sayings {
    Words tags;
    Words read;                        ///< also what another line tells of
    Words idle;                        ///< changes nothing here
    std::vector<AtRest> standing = {}; ///< changes nothing as long as it has this value
};

const Words kEverywhere = {"name", "template", "tags", "printLog", "listening", "bbox", "mstate", "topology"};
const Words kIdleBeginnings = {"draw", "show", "print", "display", "graph", "vonMises", "computeVonMises"};

// The attributes are those of SOFA 22.06 to 25.12. What is not read and not without effect is in no list.
const std::vector<Sayings>& sayings()
{
    static const std::vector<Sayings> all = {
        {.tags = {"Node"},
         .read = {"activated", "gravity", "dt"},
         .idle = {"time", "animate", "multiThreadSimulation", "depend", "sleeping", "canChangeSleepingState",
                  "currentLevel", "coarsestLevel", "finestLevel"}},
        {.tags = kElastic,
         .read = {"youngModulus", "poissonRatio", "method"},
         // The other two constants of plasticity act only below plasticMaxThreshold.
         .idle = {"computeGlobalMatrix", "assembling", "updateStiffness", "gatherPt", "gatherBsize", "isToPrint",
                  "plasticYieldThreshold", "plasticCreep", "lumpedMass", "nbThreads"},
         .standing = {{"updateStiffnessMatrix", 0},
                      {"localStiffnessFactor", 1},
                      {"plasticMaxThreshold", 0},
                      {"rayleighStiffness", 0}}},
        {.tags = kHyperelastic,
         .read = {"materialName", "ParameterSet"},
         .idle = {"AnisotropyDirections", "matrixRegularization"}, // directions of materials that are refused
         .standing = {{"rayleighStiffness", 0}}},
        {.tags = kSprings,
         .read = {"stiffness", "damping", "linesStiffness", "linesDamping", "tetrasStiffness", "tetrasDamping",
                  "tetrahedraStiffness", "tetrahedraDamping"},
         .idle = {},
         .standing = {{"noCompression", 0},
                      {"elongationOnly", 0},
                      {"enabled", 1},
                      {"rayleighStiffness", 0},
                      {"trianglesStiffness", 0},
                      {"trianglesDamping", 0},
                      {"quadsStiffness", 0},
                      {"quadsDamping", 0},
                      {"cubesStiffness", 0},
                      {"cubesDamping", 0}}},
        {.tags = kMasses,
         .read = {"totalMass", "massDensity", "vertexMass", "mass"},
         .idle = {"computeMassOnRest", "geometryState", "lumping", "separateGravity", "handleTopologicalChanges"},
         .standing = {{"rayleighMass", 0}, {"preserveTotalMass", 0}, {"compute_mapping_inertia", 0}}},
        {.tags = kImplicit,
         .read = {"rayleighStiffness", "rayleighMass"},
         .idle = {"solveConstraint", "threadSafeVisitor", "linearSolver", "computeResidual", "verbose", "newtonError",
                  "steps", "saveEnergyInFile", "file", "computeHamiltonian", "hamiltonianEnergy", "gamma", "beta",
                  "useIncrementalPotentialEnergy"},
         .standing = {{"vdamping", 0}, {"firstOrder", 0}, {"trapezoidalScheme", 0}, {"explicitIntegration", 0}}},
        {.tags = kExplicit,
         .read = {"symplectic"},
         .idle = {"threadSafeVisitor", "linearSolver", "optimizedForDiagonalMatrix"}},
        {.tags = kFixed,
         .read = {"indices", "fixAll"},
         .idle = {"activate_projectVelocity", "group", "constraintIndex"},
         .standing = {{"endTime", -1}}},
        {.tags = {"RestShapeSpringsForceField"},
         .read = {"points", "indices", "stiffness", "external_rest_shape"},
         .idle = {"angularStiffness", "external_points", "recompute_indices", "springColor"}, // angles of rigid ones
         .standing = {{"activeDirections", 1}, {"rayleighStiffness", 0}}},
        {.tags = {"ConstantForceField"},
         .read = {"indices", "totalForce", "force", "forces"},
         .idle = {},
         .standing = {{"indexFromEnd", 0}, {"rayleighStiffness", 0}}},
        {.tags = kCollision,
         .read = {"selfCollision", "group"},
         // Contact is exact: the stiffness of a penalty is of no use.
         .idle = {"simulated", "moving", "contactStiffness", "contactResponse", "color", "computeNormals",
                  "numberOfContacts", "previous", "next", "collisionElementActiver", "useCurvature"},
         .standing = {{"active", 1},
                      {"bothSide", 0},
                      {"contactDistance", 0},
                      {"proximity", 0},
                      {"contactFriction", 0},
                      {"contactRestitution", 0}}},
        {.tags = {"MechanicalObject"},
         .read = {"translation", "rotation", "scale", "scale3d", "dx", "dy", "dz", "rx", "ry", "rz", "sx", "sy", "sz",
                  "src", "position"},
         .idle = {"force", "derivX", "free_position", "free_velocity", "reset_position", "reset_velocity", "constraint",
                  "mappingJacobian", "useTopology", "reserve", "size"},
         .standing = {{"velocity", 0},
                      {"externalForce", 0},
                      {"restScale", 1},
                      {"translation2", 0},
                      {"rotation2", 0},
                      {"dx2", 0},
                      {"dy2", 0},
                      {"dz2", 0},
                      {"rx2", 0},
                      {"ry2", 0},
                      {"rz2", 0}}},
        {.tags = {"BoxROI", "BoxConstraint"},
         .read = {"box"},
         .idle = {"src", "position", "rest_position", "edges", "triangles", "quads", "tetrahedra", "hexahedra",
                  "computeEdges", "computeTriangles", "computeQuads", "computeTetrahedra", "computeHexahedra", "strict",
                  "doUpdate", "indices"}},
        {.tags = {"RegularGridTopology"},
         .read = {"n", "nx", "ny", "nz", "min", "max", "xmin", "ymin", "zmin", "xmax", "ymax", "zmax", "p0"},
         .idle = {"computeHexaList", "computeQuadList", "computeTriangleList", "computeEdgeList", "computePointList",
                  "createTexCoords", "computeAllBuffers", "position", "edges", "triangles", "quads", "tetrahedra",
                  "hexahedra"},
         .standing = {{"scale", 1}, {"cellWidth", 0}}},
        {.tags = {"MinProximityIntersection", "LocalMinDistance", "NewProximityIntersection"},
         .read = {"contactDistance"},
         .idle = {"alarmDistance", "angleCone", "coneFactor", "filterIntersection", "useLMDFilters",
                  "useSphereTriangle", "usePointPoint", "useSurfaceNormals", "useLinePoint", "useLineLine"}},
        {.tags = {"RigidMapping"},
         .read = {"input", "output"},
         .idle = {"mapForces", "mapConstraints", "mapMasses", "mapMatrices", "isMechanical", "applyRestPosition",
                  "geometricStiffness", "useX0"},
         .standing = {{"index", 0}, {"rigidIndexPerPoint", 0}, {"globalToLocalCoords", 0}, {"indexFromEnd", 0}}},
        {.tags = {"OglModel"},
         .read = {"filename", "fileMesh", "src", "color", "translation", "rotation", "scale", "scale3d", "dx", "dy",
                  "dz", "rx", "ry", "rz", "sx", "sy", "sz"},
         .idle = {"position",
                  "restPosition",
                  "vertices",
                  "normal",
                  "normals",
                  "edges",
                  "triangles",
                  "quads",
                  "tangents",
                  "bitangents",
                  "texcoords",
                  "vertPosIdx",
                  "vertNormIdx",
                  "initRestPositions",
                  "material",
                  "materials",
                  "groups",
                  "texturename",
                  "putOnlyTexCoords",
                  "srgbTexturing",
                  "scaleTex",
                  "translationTex",
                  "useNormals",
                  "updateNormals",
                  "computeNormals",
                  "computeTangents",
                  "updateTangents",
                  "computeTextureCoordinates",
                  "handleDynamicTopology",
                  "fixMergedUVSeams",
                  "keepLines",
                  "castshadow",
                  "flip",
                  "su",
                  "sv",
                  "du",
                  "dv",
                  "diffuse",
                  "enable",
                  "isEnabled",
                  "blendTranslucency",
                  "blendTransparency",
                  "premultipliedAlpha",
                  "writeZTransparent",
                  "alphaBlend",
                  "depthTest",
                  "cullFace",
                  "lineWidth",
                  "pointSize",
                  "lineSmooth",
                  "pointSmooth",
                  "primitiveType",
                  "blendEquation",
                  "sfactor",
                  "dfactor",
                  "isToPrint",
                  "invertPrimOrientation",
                  "updateVisual"},
         .standing = {}},
    };
    return all;
}

/// Files of meshes of all kinds.
const Sayings& loaderSayings()
{
    static const Sayings all = {
        .tags = {},
        .read = {"filename", "translation", "rotation", "scale", "scale3d"},
        .idle = {"position",
                 "edges",
                 "triangles",
                 "quads",
                 "tetrahedra",
                 "hexahedra",
                 "normals",
                 "triangulate",
                 "createSubelements",
                 "onlyAttachedPoints",
                 "handleSeams",
                 "loadMaterial",
                 "defaultMaterial",
                 "materials",
                 "material",
                 "edgesGroups",
                 "trianglesGroups",
                 "quadsGroups",
                 "polygonsGroups",
                 "tetrahedraGroups",
                 "hexahedraGroups",
                 "computeMaterialFaces",
                 "headerSize",
                 "forceBinary",
                 "mergePositionUsingMap"},
        .standing = {{"flipNormals", 0}},
    };
    return all;
}

const Sayings* sayingsOf(std::string_view tag)
{
    for (const Sayings& each : sayings())
        if (isOneOf(tag, each.tags)) return &each;
    // The spheres of a SphereLoader are told where they collide.
    return tag.ends_with("Loader") && tag != "SphereLoader" ? &loaderSayings() : nullptr;
}

double valueOf(std::string_view word)
{
    if (word == "true" || word == "false") return word == "true" ? 1.0 : 0.0;
    double value = std::numeric_limits<double>::quiet_NaN();
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    return end == word.data() + word.size() ? value : std::numeric_limits<double>::quiet_NaN();
}

bool isAtRest(std::string_view words, double value)
{
    bool all = true;
    forEachWord(words, [&](std::string_view word) { all = all && valueOf(word) == value; });
    return all;
}

/// Positions of a state are read of rigid ones, as numbers; soft ones have those of their mesh, to which links lead.
bool arePositionsRead(const Element& state, bool ofRest)
{
    const auto said = [&](const char* attribute) { return std::string_view(state.node.attribute(attribute).value()); };
    const bool rigid = said("template").starts_with("Rigid");
    if (ofRest) return rigid || said("rest_position") == said("position");
    return said("position").empty() || rigid != said("position").starts_with('@');
}

bool changesNothing(const Element& element, const Sayings& known, std::string_view name, std::string_view words)
{
    if (element.tag() == "MechanicalObject" && (name == "position" || name == "rest_position"))
        return arePositionsRead(element, name == "rest_position");
    if (isOneOf(name, kEverywhere) || isOneOf(name, known.read) || isOneOf(name, known.idle) ||
        std::ranges::any_of(kIdleBeginnings, [&](std::string_view each) { return name.starts_with(each); }))
        return true;
    const auto standing = std::ranges::find(known.standing, name, &AtRest::name);
    return standing != known.standing.end() && isAtRest(words, standing->value);
}

/// A slip of the pen in the name of a component; many of SOFA's names differ by a word, which is none.
std::string meantTag(std::string_view tag)
{
    constexpr int kSlip = 2;
    for (const std::string_view each : readTags())
        if (editDistance(tag, each) <= kSlip) return text(" (did you mean '", each, "'?)");
    return {};
}

bool isRead(std::string_view tag)
{
    static const Words endings = {"Loader",
                                  "Topology",
                                  "TopologyContainer",
                                  "TopologyModifier",
                                  "GeometryAlgorithms",
                                  "Mapping",
                                  "ConstraintCorrection"};
    return isOneOf(tag, readTags()) || isOneOf(tag, kSilent) ||
           std::ranges::any_of(endings, [&](std::string_view each) { return tag.ends_with(each); });
}

} // namespace

void tellUnreadAttributes(const Element& element, XmlReader& reader)
{
    const Sayings* const known = sayingsOf(element.tag());
    if (!known) return;
    for (const pugi::xml_attribute each : element.node.attributes()) {
        const std::string_view name = each.name();
        if (changesNothing(element, *known, name, each.value())) continue;
        // A name that SOFA has is no slip of another.
        const bool exists = isOneOf(name, known->read) ||
                            std::ranges::find(known->standing, name, &AtRest::name) != known->standing.end();
        const Words meant = exists ? Words() : known->read;
        reader.tellUnread(element, name, {meant.begin(), meant.end()});
    }
}

void tellUnreadOf(const Element& component, XmlReader& reader)
{
    if (isRead(component.tag())) return tellUnreadAttributes(component, reader);
    reader.tell(component, text("<", component.tag()),
                text("<", shortened(component.tag()), "> is not read", meantTag(component.tag())));
}

std::optional<Vec3> colourNamed(std::string_view words)
{
    struct Named {
        std::string_view name;
        Vec3 colour;
    };
    static const std::vector<Named> known = {{"white", {1, 1, 1}},
                                             {"black", {0, 0, 0}},
                                             {"red", {1, 0, 0}},
                                             {"green", {0, 1, 0}},
                                             {"blue", {0, 0, 1}},
                                             {"cyan", {0, 1, 1}},
                                             {"magenta", {1, 0, 1}},
                                             {"yellow", {1, 1, 0}},
                                             {"gray", {0.5, 0.5, 0.5}},
                                             {"darkgray", {.25, .25, .25}},
                                             {"lightgray", {.75, .75, .75}},
                                             {"orange", {1, 0.5, 0}},
                                             {"purple", {0.5, 0, 0.5}},
                                             {"pink", {1, 0, 0.5}},
                                             {"brown", {0.6, 0.3, 0}},
                                             {"lime", {0.5, 1, 0}},
                                             {"teal", {0, 0.5, 0.5}},
                                             {"navy", {0, 0, 0.5}},
                                             {"olive", {0.5, 0.5, 0}},
                                             {"maroon", {0.5, 0, 0}},
                                             {"silver", {0.75, 0.75, 0.75}},
                                             {"gold", {1, 0.84, 0}},
                                             {"azure", {0, 0.5, 1}}};
    if (const auto found = std::ranges::find(known, words, &Named::name); found != known.end()) return found->colour;
    if (!words.starts_with('#') || (words.size() != 7 && words.size() != 9)) return {};
    unsigned bits = 0;
    const char* const end = words.data() + words.size();
    const auto [read, problem] = std::from_chars(words.data() + 1, end, bits, 16);
    if (problem != std::errc{} || read != end) return {};
    if (words.size() == 9) bits >>= 8;
    return Vec3{(bits >> 16 & 0xff) / 255.0, (bits >> 8 & 0xff) / 255.0, (bits & 0xff) / 255.0};
}

} // namespace filasofia::scene
