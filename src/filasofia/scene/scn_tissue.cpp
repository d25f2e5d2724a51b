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
    readMaterial(lawOf(node), def);
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
        const auto named = [&](std::initializer_list<std::string_view> names, std::string_view standard) {
            const auto found = says.findAny(names);
            return found ? found->name : standard;
        };
        def.material = physics::MassSpringMaterial{
            .stiffness = firstOf(says, named({"stiffness", "linesStiffness", "tetrasStiffness"}, "stiffness"), 100.0,
                                 positive()),
            .damping =
                firstOf(says, named({"damping", "linesDamping", "tetrasDamping"}, "damping"), 0.0, nonNegative())};
    } else {
        physics::FemMaterial material;
        material.law = physics::Corotational{};
        material.youngModulus = firstOf(says, "youngModulus", 5000.0, positive());
        material.poissonRatio = std::min(firstOf(says, "poissonRatio", 0.45, closedOpen(0, 0.5)), 0.4999);
        if (reader_.word(says, "method") == "small")
            reader_.note(law, "small", "method \"small\" is read as corotational elasticity");
        def.material = material;
    }
}

physics::FemMaterial ScnTissue::hyperelastic(const Element& law)
{
    const Attributes says(law);
    const auto parameters = says.find("ParameterSet");
    const std::string name = reader_.word(says, "materialName");
    const bool venant = name == "StVenantKirchhoff";
    if (!parameters || (!venant && name != "StableNeoHookean" && name != "NeoHookean"))
        reader_.refuse(
            law, "must have the material StVenantKirchhoff, NeoHookean or StableNeoHookean, and its ParameterSet");
    const std::vector<double> values = reader_.numbers(*parameters, 2, 2, positive());
    const double mu = values[0];
    const double lambda = name == "NeoHookean" ? values[1] - 2.0 / 3.0 * mu : values[1]; // a bulk modulus there
    physics::FemMaterial material;
    if (venant)
        material.law = physics::StVenantKirchhoff{};
    else
        material.law = physics::NeoHookean{};
    material.youngModulus = mu * (3 * lambda + 2 * mu) / (lambda + mu);
    material.poissonRatio = std::clamp(lambda / (2 * (lambda + mu)), 0.0, 0.4999);
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
    if (says.has("massDensity"))
        def.mass = physics::Density{firstOf(says, "massDensity", 1.0, positive())};
    else if (says.has("totalMass"))
        def.mass = physics::TotalMass{firstOf(says, "totalMass", 1.0, positive())};
    else
        def.mass = physics::TotalMass{firstOf(says, says.has("vertexMass") ? "vertexMass" : "mass", 1.0, positive()) *
                                      static_cast<double>(mesh.nodes.size())};
}

void ScnTissue::readSolver(const Element& node, physics::SoftBodyDef& def)
{
    if (const Element implicit = source_.inherited(node, kImplicit)) {
        const Attributes says(implicit);
        def.rayleigh = {.mass = reader_.number(says, "rayleighMass", 0.0, nonNegative()),
                        .stiffness = reader_.number(says, "rayleighStiffness", 0.0, nonNegative())};
    } else if (source_.inherited(node, kExplicit)) {
        def.integrator = physics::ExplicitEuler{};
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
            const Vec3 force = 1.0 / (total ? static_cast<double>(nodes.size()) : 1.0) * Vec3{v[k], v[k + 1], v[k + 2]};
            def.forces.push_back({nodes[i], rotate(world_.orientation, force)});
        }
    }
}

} // namespace filasofia::scene
