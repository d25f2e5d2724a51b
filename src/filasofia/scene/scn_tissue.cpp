#include "filasofia/scene/scn_tissue.h"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace filasofia::scene {

using geometry::TetMesh;

const std::vector<std::string_view> kElastic = {"TetrahedronFEMForceField",
                                                "TetrahedralCorotationalFEMForceField",
                                                "FastTetrahedralCorotationalForceField",
                                                "ParallelTetrahedronFEMForceField",
                                                "HexahedronFEMForceField",
                                                "HexahedronFEMForceFieldAndMass",
                                                "HexahedralFEMForceField",
                                                "ParallelHexahedronFEMForceField"};
const std::vector<std::string_view> kHyperelastic = {"TetrahedronHyperelasticityFEMForceField"};
const std::vector<std::string_view> kSprings = {"MeshSpringForceField", "RegularGridSpringForceField"};
const std::vector<std::string_view> kMasses = {"UniformMass", "DiagonalMass", "MeshMatrixMass"};
const std::vector<std::string_view> kImplicit = {"EulerImplicitSolver", "EulerImplicit", "NewmarkImplicitSolver",
                                                 "VariationalSymplecticSolver"};
const std::vector<std::string_view> kExplicit = {"EulerExplicitSolver", "EulerSolver"};
const std::vector<std::string_view> kFixed = {"FixedProjectiveConstraint", "FixedConstraint",
                                              "FixedLagrangianConstraint"};

Element ScnTissue::lawOf(const Element& node) const
{
    for (const auto* tags : {&kElastic, &kHyperelastic, &kSprings})
        if (const Element found = source_.component(node, *tags)) return found;
    return {};
}

void ScnTissue::read(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
{
    std::vector<std::string_view> laws;
    for (const auto* tags : {&kElastic, &kHyperelastic, &kSprings}) laws.insert(laws.end(), tags->begin(), tags->end());
    tellFurther(node, laws, "elasticity");
    tellFurther(node, kMasses, "mass");
    readMaterial(lawOf(node), def);
    if (auto* fem = std::get_if<physics::FemMaterial>(&def.material)) fem->youngModulus /= unit_;
    readMass(node, mesh, def);
    readSolver(node, def);
    pin(node, mesh, def);
    readForces(node, mesh, def);
}

void ScnTissue::readMaterial(const Element& law, physics::SoftBodyDef& def)
{
    const Attributes says(law);
    if (isOneOf(law.tag(), kHyperelastic)) {
        def.material = hyperelastic(law);
    } else if (isOneOf(law.tag(), kSprings)) {
        readSprings(says, def);
    } else {
        physics::FemMaterial material;
        material.law = physics::Corotational{};
        material.youngModulus = firstOf(says, "youngModulus", 5000.0, positive());
        material.poissonRatio = bounded(law, firstOf(says, "poissonRatio", 0.45, closedOpen(0, 0.5)));
        if (const std::string method = reader_.word(says, "method");
            method == "small" || method == "linear" || method == "none")
            reader_.note(law, "small", text("method \"", method, "\" is read as corotational elasticity"));
        def.material = material;
    }
}

double ScnTissue::bounded(const Element& law, double ratio)
{
    constexpr double most = 0.4999;
    if (ratio > most) reader_.note(law, "nu", text("a Poisson's ratio above ", most, " is read as ", most));
    return std::min(ratio, most);
}

void ScnTissue::readSprings(const Attributes& says, physics::SoftBodyDef& def)
{
    def.material = physics::MassSpringMaterial{
        .stiffness =
            firstOf(says, oneOf(says, {"stiffness", "linesStiffness", "tetrahedraStiffness", "tetrasStiffness"}), 100.0,
                    positive()),
        .damping = firstOf(says, oneOf(says, {"damping", "linesDamping", "tetrahedraDamping", "tetrasDamping"}), 0.0,
                           nonNegative())};
}

std::string_view ScnTissue::oneOf(const Attributes& says, std::initializer_list<std::string_view> names)
{
    const auto first = says.findAny(names);
    if (!first) return *names.begin();
    for (const std::string_view each : names)
        if (const auto other = says.find(each); other && each != first->name && other->words != first->words)
            reader_.tell(other->at, text(each, " beside"),
                         text("<", other->at.tag(), "> ", each, " is not read beside ", first->name));
    return first->name;
}

bool ScnTissue::actsOnTissue(std::string_view tag)
{
    return isOneOf(tag, kElastic) || isOneOf(tag, kHyperelastic) || isOneOf(tag, kSprings) ||
           tag == "RestShapeSpringsForceField" || tag == "ConstantForceField";
}

void ScnTissue::tellFurther(const Element& node, const std::vector<std::string_view>& tags, std::string_view what)
{
    bool first = true;
    for (const Element& each : source_.componentsIn(node)) {
        if (!isOneOf(each.tag(), tags)) continue;
        if (!first)
            reader_.tell(
                each, text("further ", what),
                text("<", each.tag(), "> is not read: a <Node> has one ", what, " here, and adds them in SOFA"));
        first = false;
    }
}

physics::FemMaterial ScnTissue::hyperelastic(const Element& law)
{
    constexpr const char* read = "StVenantKirchhoff, NeoHookean, StableNeoHookean or MooneyRivlin";
    const Attributes says(law);
    const auto parameters = says.find("ParameterSet");
    const auto named = says.find("materialName");
    if (!named) reader_.refuse(law, text("must have the materialName ", read));
    const std::string_view name = named->words;
    if (name != "StVenantKirchhoff" && name != "NeoHookean" && name != "StableNeoHookean" && name != "MooneyRivlin")
        reader_.refuse(*named, text("must be ", read));
    if (!parameters) reader_.refuse(law, "must have a ParameterSet");
    if (name == "NeoHookean" || name == "MooneyRivlin")
        reader_.note(law, text("volume ", name),
                     text("the pressure of ", name, " goes with J - 1, and not with ln J / J: alike near J = 1"));
    if (name == "MooneyRivlin") return mooneyRivlin(says);
    const std::vector<double> values = reader_.numbers(*parameters, 2, 2, positive());
    const double mu = values[0];
    const double lambda = values[1];
    if (name == "NeoHookean")
        reader_.note(law, "NeoHookean",
                     "the ParameterSet of NeoHookean is read as that of SOFA since 24.06: mu, lambda");
    physics::FemMaterial material;
    if (name == "StVenantKirchhoff")
        material.law = physics::StVenantKirchhoff{};
    else
        material.law = physics::NeoHookean{};
    material.youngModulus = mu * (3 * lambda + 2 * mu) / (lambda + mu);
    material.poissonRatio = bounded(law, lambda / (2 * (lambda + mu)));
    return material;
}

// SOFA: W = c1 (i1 - 3) + c2 (i2 - 3) + k0/2 ln^2 J, with the invariants at constant volume.
physics::FemMaterial ScnTissue::mooneyRivlin(const Attributes& says)
{
    const std::vector<double> values = reader_.numbers(*says.find("ParameterSet"), 3, 3, nonNegative());
    const double shear = 2 * (values[0] + values[1]), bulk = values[2];
    const double ratio = (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
    if (!(shear > 0.0 && ratio >= 0.0))
        reader_.refuse(*says.find("ParameterSet"), "must be c1, c2 and k0 with c1 + c2 > 0 and k0 >= 4/3 (c1 + c2)");
    physics::FemMaterial material;
    material.law = physics::MooneyRivlin{.share = values[1] / (values[0] + values[1])};
    material.poissonRatio = bounded(says.element(), ratio);
    material.youngModulus = 2 * shear * (1 + material.poissonRatio);
    return material;
}

double ScnTissue::firstOf(const Attributes& from, std::string_view name, double standard, const Range& range)
{
    const auto found = from.find(name);
    if (!found || found->words.starts_with('@')) return standard;
    const std::vector<double> all = reader_.numbers(*found, 1, 10'000'000, range);
    if (std::ranges::any_of(all, [&](double each) { return each != all.front(); }))
        reader_.tell(found->at, text("list ", name), text("of the list ", name, " only the first number is read"));
    return all.front();
}

void ScnTissue::readMass(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
{
    const Element mass = source_.inherited(node, kMasses);
    if (!mass) return reader_.note(node, "no mass", "a body without a mass gets 1000 kg/m^3");
    const Attributes says(mass);
    const auto oneNode = [&](std::string_view name) {
        return physics::TotalMass{firstOf(says, name, 1.0, positive()) * static_cast<double>(mesh.nodes.size())};
    };
    // What counts of several is what counts in SOFA.
    const auto beside = [&](std::string_view counts) {
        for (const std::string_view each : {"totalMass", "massDensity", "vertexMass"})
            if (each != counts && says.has(each))
                reader_.tell(mass, text(each, " beside"),
                             text("<", mass.tag(), "> ", each, " is not read beside ", counts));
    };
    if (says.has("totalMass"))
        beside("totalMass"), def.mass = physics::TotalMass{firstOf(says, "totalMass", 1.0, positive())};
    else if (says.has("massDensity"))
        beside("massDensity"),
            def.mass = physics::Density{firstOf(says, "massDensity", 1.0, positive()) / (unit_ * unit_ * unit_)};
    else
        def.mass = oneNode(says.has("vertexMass") ? "vertexMass" : "mass");
}

void ScnTissue::readSolver(const Element& node, physics::SoftBodyDef& def)
{
    if (const Element implicit = source_.inherited(node, kImplicit)) {
        const Attributes says(implicit);
        def.rayleigh = {.mass = reader_.number(says, "rayleighMass", 0.0, nonNegative()),
                        .stiffness = reader_.number(says, "rayleighStiffness", 0.0, nonNegative())};
        if (!implicit.tag().starts_with("EulerImplicit"))
            reader_.note(implicit, "implicit", text("<", implicit.tag(), "> is read as an EulerImplicitSolver"));
    } else if (const Element explicitly = source_.inherited(node, kExplicit)) {
        def.integrator = physics::ExplicitEuler{.symplectic = reader_.flag(Attributes(explicitly), "symplectic", true)};
    } else {
        reader_.note(node, "no solver", "a body without a solver that is read is solved implicitly");
    }
}

std::vector<int> ScnTissue::numbered(const Attribute& indices, std::size_t nodes) const
{
    std::vector<int> all;
    std::istringstream stream{std::string(indices.words)}; // "0-3" is 0 1 2 3
    for (std::string word; stream >> word;) {
        const std::size_t dash = word.find('-', 1);
        const auto number = [&](const std::string& part) {
            const std::vector<int> one = reader_.wholes({indices.at, indices.name, part}, closed(0, 1e9));
            if (one.empty()) reader_.refuse(indices, "must consist of whole numbers and ranges such as 0-3");
            return one.front();
        };
        const int first = number(word.substr(0, dash));
        const int last = dash == std::string::npos ? first : number(word.substr(dash + 1));
        if (last >= static_cast<int>(nodes)) reader_.refuse(indices, text("must be in [0, ", nodes, ")"));
        for (int i = first; i <= last; ++i) all.push_back(i);
    }
    return all;
}

std::vector<int> ScnTissue::nodesOf(const Attributes& says, std::initializer_list<std::string_view> names,
                                    const TetMesh& mesh)
{
    const auto found = says.findAny(names);
    if (!found) return {0}; // SOFA's default
    if (!found->words.starts_with('@')) return numbered(*found, mesh.nodes.size());
    const Element from = source_.linked(*found);
    const auto box =
        from && (from.tag() == "BoxROI" || from.tag() == "BoxConstraint") ? Attributes(from).find("box") : std::nullopt;
    if (!box) {
        reader_.tell(says.element(), text("indices ", says.element().tag()),
                     text("<", says.element().tag(), "> is read with indices that are numbers or those of a BoxROI"));
        return {};
    }
    const std::vector<double> v = reader_.numbers(*box, 6, 6000);
    std::vector<int> inside;
    for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
        for (std::size_t i = 0; i + 6 <= v.size(); i += 6) {
            geometry::Box made;
            made = merged(merged(made, Vec3{v[i], v[i + 1], v[i + 2]}), Vec3{v[i + 3], v[i + 4], v[i + 5]});
            if (!contains(made, mesh.nodes[node])) continue;
            inside.push_back(static_cast<int>(node));
            break;
        }
    if (inside.empty()) reader_.note(from, "empty box", "a <BoxROI> holds no node, and what names it does nothing");
    return inside;
}

void ScnTissue::pin(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
{
    const auto attach = [&](std::vector<int> nodes, double stiffness) {
        if (!nodes.empty()) def.attachments.push_back({.nodes = std::move(nodes), .stiffness = stiffness});
    };
    for (const Element& each : source_.componentsIn(node)) {
        const Attributes says(each);
        if (isOneOf(each.tag(), kFixed)) {
            std::vector<int> all(mesh.nodes.size());
            std::iota(all.begin(), all.end(), 0);
            attach(reader_.flag(says, "fixAll", false) ? all : nodesOf(says, {"indices"}, mesh), physics::kHard);
        } else if (each.tag() == "RestShapeSpringsForceField") {
            if (says.has("external_rest_shape"))
                reader_.tell(each, "external", "<RestShapeSpringsForceField> to another state is not read");
            else
                attach(nodesOf(says, {"points", "indices"}, mesh), firstOf(says, "stiffness", 100.0, positive()));
        }
    }
}

void ScnTissue::readForces(const Element& node, const TetMesh& mesh, physics::SoftBodyDef& def)
{
    for (const Element& each : source_.componentsIn(node)) {
        if (each.tag() != "ConstantForceField") continue;
        const Attributes says(each);
        std::vector<int> nodes(mesh.nodes.size());
        std::iota(nodes.begin(), nodes.end(), 0);
        if (says.has("indices")) nodes = nodesOf(says, {"indices"}, mesh);
        if (nodes.empty()) continue;
        const bool total = says.has("totalForce");
        const auto given = says.findAny({"totalForce", "force", "forces"});
        if (!given || given->words.starts_with('@')) {
            reader_.tell(each, "ConstantForceField", "<ConstantForceField> is read with totalForce, force or forces");
            continue;
        }
        const std::vector<double> v = reader_.numbers(*given, 3, 3'000'000);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const std::size_t k = total || given->name == "force" ? 0 : std::min(3 * i, 3 * (v.size() / 3 - 1));
            const Vec3 force =
                unit_ / (total ? static_cast<double>(nodes.size()) : 1.0) * Vec3{v[k], v[k + 1], v[k + 2]};
            def.forces.push_back({nodes[i], rotate(world_.orientation, force)});
        }
    }
}

} // namespace filasofia::scene
