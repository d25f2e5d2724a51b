#include "filasofia/record/recording.h"

#include "filasofia/core/log.h"
#include "record/round_trip.h"

namespace recording_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::record_test;

TEST_CASE("a step's content comes back bit for bit")
{
    StepRecord step; // every flag except RecordLost and Tuned, which warn
    step.report = {.step = 123456789012345678u, .dt = kThird, .flags = 0xffffff9fu};
    step.report.solves = {{.body = {}, .iterations = 17}, {.body = {}, .iterations = 0}};
    step.hash = 0xfedcba9876543210u;
    const StepRecord back = roundTrip(step);
    CHECK(back.report.step == step.report.step);
    CHECK(sameBits(back.report.dt, kThird));
    CHECK(back.report.flags == step.report.flags);
    REQUIRE(back.report.solves.size() == 2);
    CHECK(back.report.solves[0].iterations == 17);
    CHECK(back.report.solves[1].iterations == 0);
    CHECK(back.hash == step.hash);
    CHECK(back.commands.empty());
}

TEST_CASE("a shell comes back bit for bit, its triangles with it")
{
    geometry::TriangleMesh mesh{{kVec, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
    const SoftBodyDef def{.mesh = std::make_shared<const geometry::TriangleMesh>(mesh),
                          .material = ShellMaterial{.youngModulus = kLarge,
                                                    .poissonRatio = kThird,
                                                    .thickness = kTiny,
                                                    .bendingScale = 0.0,
                                                    .validStrain = kThird}};
    const SoftBodyDef back = roundTrip(def);
    const auto held = std::get<std::shared_ptr<const geometry::TriangleMesh>>(back.mesh);
    CHECK(held->triangles == mesh.triangles);
    CHECK(sameBits(held->vertices[0], kVec));
    const auto& material = std::get<ShellMaterial>(back.material);
    CHECK(material.youngModulus == kLarge);
    CHECK(sameBits(material.poissonRatio, kThird));
    CHECK(sameBits(material.thickness, kTiny));
    CHECK(material.bendingScale == 0.0);
    CHECK(sameBits(material.validStrain, kThird));
}

TEST_CASE("every field of a soft body comes back bit for bit, its mesh with it")
{
    auto mesh = *oneTetrahedron();
    mesh.nodes[2] = kVec;
    const SoftBodyDef def{
        .name = "liver \"left\"\nlobe \xc3\xa9",
        .mesh = std::make_shared<const geometry::TetMesh>(mesh),
        .pose = kPose,
        .material = MassSpringMaterial{.stiffness = kLarge, .damping = kTiny},
        .mass = TotalMass{kThird},
        .rayleigh = {.mass = kThird, .stiffness = kMinusZero},
        .gravity = false,
        .integrator = ExplicitEuler{.symplectic = true},
        .solver = ConjugateGradient{.maxIterations = 7, .tolerance = kThird, .minIterations = 3, .assembled = true},
        .attachments = {{.nodes = {0, 3}, .stiffness = kHard},
                        {.box = geometry::Box{kVec, {1, 2, 3}}, .stiffness = kThird}},
        .forces = {{.node = 2, .force = kVec}},
        .pressure = -kThird};
    const SoftBodyDef back = roundTrip(def);
    CHECK(back.name == def.name);
    const auto& nodes = std::get<std::shared_ptr<const geometry::TetMesh>>(back.mesh)->nodes;
    CHECK(std::equal(nodes.begin(), nodes.end(), mesh.nodes.begin(), mesh.nodes.end(),
                     [](Vec3 a, Vec3 b) { return sameBits(a, b); }));
    CHECK(std::get<std::shared_ptr<const geometry::TetMesh>>(back.mesh)->tetrahedra == mesh.tetrahedra);
    CHECK(sameBits(back.pose, kPose));
    CHECK(std::get<MassSpringMaterial>(back.material).stiffness == kLarge);
    CHECK(sameBits(std::get<MassSpringMaterial>(back.material).damping, kTiny));
    CHECK(sameBits(std::get<TotalMass>(back.mass).value, kThird));
    CHECK(sameBits(back.rayleigh.mass, kThird));
    CHECK(sameBits(back.rayleigh.stiffness, kMinusZero));
    CHECK_FALSE(back.gravity);
    CHECK(std::get<ExplicitEuler>(back.integrator).symplectic);
    const auto& solver = std::get<ConjugateGradient>(back.solver);
    CHECK(solver.maxIterations == 7);
    CHECK(sameBits(solver.tolerance, kThird));
    CHECK(solver.minIterations == 3);
    CHECK(solver.assembled);
    REQUIRE(back.attachments.size() == 2);
    CHECK(back.attachments[0].nodes == std::vector<int>{0, 3});
    CHECK_FALSE(back.attachments[0].box);
    CHECK(back.attachments[0].stiffness == kHard);
    CHECK(back.attachments[1].nodes.empty());
    REQUIRE(back.attachments[1].box);
    CHECK(sameBits(back.attachments[1].box->low, kVec));
    CHECK(back.attachments[1].box->high == Vec3{1, 2, 3});
    CHECK(sameBits(back.attachments[1].stiffness, kThird));
    REQUIRE(back.forces.size() == 1);
    CHECK(back.forces[0].node == 2);
    CHECK(sameBits(back.forces[0].force, kVec));
    CHECK(sameBits(back.pressure, -kThird));
}

TEST_CASE("the other alternatives of a soft body come back")
{
    const SoftBodyDef back = roundTrip(SoftBodyDef{.mesh = oneTetrahedron(),
                                                   .material = FemMaterial{.youngModulus = kThird, .poissonRatio = 0.1},
                                                   .mass = Density{kThird},
                                                   .integrator = ImplicitEuler{},
                                                   .solver = Cholesky{}});
    CHECK(sameBits(std::get<FemMaterial>(back.material).youngModulus, kThird));
    CHECK(sameBits(std::get<FemMaterial>(back.material).poissonRatio, 0.1));
    CHECK(sameBits(std::get<Density>(back.mass).value, kThird));
    CHECK(std::holds_alternative<ImplicitEuler>(back.integrator));
    CHECK(std::holds_alternative<Cholesky>(back.solver));
    // No body of a server names a file any more; a Def from elsewhere may.
    CHECK(std::get<std::string>(roundTrip(SoftBodyDef{.mesh = "liver.msh"}).mesh) == "liver.msh");
}

TEST_CASE("every other kind of command comes back bit for bit")
{
    const AddBody add = roundTrip(adding(9, RigidBodyDef{.name = "forceps", .elements = {kPose, Pose{}}}));
    const auto& rigid = std::get<RigidBodyDef>(*add.def);
    CHECK(rigid.name == "forceps");
    REQUIRE(rigid.elements.size() == 2);
    CHECK(sameBits(rigid.elements[0], kPose));
    CHECK(roundTrip(RemoveBody{BodyId{4294967295u}}).id == BodyId{4294967295u});
    const auto pose = roundTrip(SetPose{BodyId{3}, 2, kPose});
    CHECK(pose.id == BodyId{3});
    CHECK(pose.element == 2);
    CHECK(sameBits(pose.pose, kPose));
    const auto wrench = roundTrip(SetWrench{BodyId{3}, 2, kVec, {kLarge, 0, kThird}});
    CHECK((wrench.id == BodyId{3} && wrench.element == 2));
    CHECK((sameBits(wrench.force, kVec) && sameBits(wrench.torque, {kLarge, 0, kThird})));
    const HapticTarget hand{kPose, kVec, {kLarge, 0, kThird}, {.linearStiffness = kThird, .torqueLimit = 0.25}};
    const auto held = roundTrip(SetHaptic{BodyId{3}, 2, hand});
    CHECK((held.id == BodyId{3} && held.element == 2 && sameBits(held.target.pose, kPose)));
    CHECK((sameBits(held.target.velocity, kVec) && sameBits(held.target.angularVelocity, {kLarge, 0, kThird})));
    CHECK(held.target.coupling == hand.coupling); // its force limit is infinite
    CHECK(sameBits(roundTrip(SetGravity{kVec}).gravity, kVec));
    const auto material = roundTrip(SetMaterial{BodyId{3}, FemMaterial{.youngModulus = kThird}});
    CHECK(material.id == BodyId{3});
    CHECK(sameBits(std::get<FemMaterial>(material.material).youngModulus, kThird));
    const auto forces = roundTrip(SetForces{BodyId{3}, {{1, kVec}, {2, {}}}});
    CHECK(forces.id == BodyId{3});
    REQUIRE(forces.forces.size() == 2);
    CHECK(forces.forces[0].node == 1);
    CHECK(sameBits(forces.forces[0].force, kVec));
    const auto pressure = roundTrip(SetPressure{BodyId{3}, kTiny});
    CHECK(pressure.id == BodyId{3});
    CHECK(sameBits(pressure.pressure, kTiny));
    const auto piece = roundTrip(RemovePiece{BodyId{3}, 4});
    CHECK((piece.id == BodyId{3} && piece.piece == 4));
    const auto soft = roundTrip(adding(10, SoftBodyDef{.mesh = oneTetrahedron(),
                                                       .material = FemMaterial{.tearingThreshold = kThird},
                                                       .dynamicTopology = true}));
    CHECK(std::get<SoftBodyDef>(*soft.def).dynamicTopology);
    CHECK(sameBits(std::get<FemMaterial>(std::get<SoftBodyDef>(*soft.def).material).tearingThreshold, kThird));
    const auto whole = roundTrip(adding(11, SoftBodyDef{.mesh = oneTetrahedron(), .material = MassSpringMaterial{}}));
    CHECK(std::isinf(std::get<MassSpringMaterial>(std::get<SoftBodyDef>(*whole.def).material).tearingThreshold));
    const TissueRegion region{.where = Ball{kVec, kThird}, .poissonRatio = 0.1, .restScale = kThird + 0.5};
    const auto tissue = roundTrip(SetTissue{BodyId{3}, region});
    CHECK((tissue.id == BodyId{3} && tissue.region == region && !tissue.factors));
    const TissueFactors factors{.youngModulus = 3.0, .tearingThreshold = kThird, .restScale = kThird + 0.5};
    CHECK(roundTrip(SetTissue{BodyId{3}, region, factors}).factors == factors);
    const auto active = roundTrip(SetFibreStress{BodyId{3}, 1, kThird});
    CHECK((active.id == BodyId{3} && active.family == 1 && sameBits(active.stress, kThird)));
    const auto bent =
        roundTrip(SetCurvature{BodyId{3}, {{.end = kThird, .curvature = {kThird, -2.0}}, {.begin = 1.0}}, kThird});
    CHECK((bent.id == BodyId{3} && bent.sections.size() == 2 && sameBits(bent.rate, kThird)));
    CHECK((sameBits(bent.sections[0].end, kThird) && sameBits(bent.sections[0].curvature[0], kThird)));
    CHECK((bent.sections[0].curvature[1] == -2.0 && bent.sections[1].begin == 1.0 && std::isinf(bent.sections[1].end)));
    const auto blade = roundTrip(SetCutting{BodyId{3}, false});
    CHECK((blade.id == BodyId{3} && !blade.cutting));
    const auto cavity = roundTrip(SetCavity{BodyId{3}, 1, kThird, {}});
    CHECK((cavity.id == BodyId{3} && cavity.cavity == 1 && !cavity.inflow && sameBits(*cavity.pressure, kThird)));
    const auto clip = roundTrip(ApplyClip{AttachmentId{4}, BodyId{3}, BodyId{2}, {.length = kThird}});
    CHECK((clip.id == AttachmentId{4} && clip.rigid == BodyId{3} && clip.target == BodyId{2}));
    CHECK(sameBits(clip.def.length, kThird));
    roundTrip(Reset{});
    CHECK(roundTrip(Pause{true}).paused);
    CHECK_FALSE(roundTrip(Pause{false}).paused);
    CHECK_FALSE(roundTrip(Tune{[](PhysicsEngine&) {}}).change); // only the fact that there was one can be kept
    STATIC_REQUIRE(std::variant_size_v<Command> == 24);
}

TEST_CASE("every law and all that a material may say come back bit for bit")
{
    std::vector<ElasticLaw> laws = elasticLaws();
    for (ElasticLaw& law : laws)
        std::visit(
            []<class Law>(Law& each) {
                forEachField<Law>([&](const auto& field) {
                    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(each.*(field.member))>, double>)
                        each.*(field.member) = kThird;
                });
            },
            law);
    laws.emplace_back(Ogden{{{-kThird, 0.25}, {3.0, 0.75}}});
    for (const ElasticLaw& law : laws) {
        FemMaterial material{.law = law};
        material.regions = {{.where = Labelled{.label = -3}, .youngModulus = kThird},
                            {.where = geometry::Box{{0, 0, 0}, kVec}, .tearingThreshold = 1.0},
                            {.where = NearSurface{kThird}, .density = 2.0},
                            {.where = AtInterface{{.label = 1}, {.label = 2}}, .restScale = 0.75},
                            {.where = Listed{{4, 7}}}};
        material.fibres = {{.stiffness = kThird, .direction = Around{kVec, {0, 1, 0}, 0.25}},
                           {.direction = DirectionField{{kVec, {}}}, .where = Labelled{.label = 4}},
                           {.activeStress = kThird, .direction = HarmonicField{Listed{{1}}, Listed{{2}}}}};
        material.relaxation = {{.share = kThird, .time = 2.0}};
        material.stiffnessField = {kThird, 1.0};
        material.validStrain = kThird;
        const auto back = std::get<FemMaterial>(roundTrip(SetMaterial{BodyId{3}, material}).material);
        CHECK(back.law == material.law);
        CHECK(back.regions == material.regions);
        CHECK(back.fibres == material.fibres);
        CHECK(back.relaxation == material.relaxation);
        CHECK(back.stiffnessField == material.stiffnessField);
        CHECK(back.validStrain == kThird);
    }
}

TEST_CASE("a mesh keeps its labels")
{
    auto labelled = *oneTetrahedron();
    labelled.labels = {42};
    const auto back = roundTrip(SoftBodyDef{.mesh = std::make_shared<const geometry::TetMesh>(labelled)});
    CHECK(std::get<std::shared_ptr<const geometry::TetMesh>>(back.mesh)->labels == labelled.labels);
}

TEST_CASE("a name that is not valid text does not end the recording")
{
    CHECK(roundTrip(SoftBodyDef{.name = "li\xffver", .mesh = oneTetrahedron()}).name == "li\xef\xbf\xbdver");
}

TEST_CASE("a mesh is written once, before the step that needs it, however often it is loaded")
{
    const record::ScratchFile file("meshes.rec");
    {
        record::RecordingWriter writer(file.path(), {.period = 0.005});
        for (std::uint32_t id = 1; id <= 3; ++id)
            writer.write(stepWith(adding(id, SoftBodyDef{.mesh = oneTetrahedron()})));
        auto other = *oneTetrahedron();
        other.nodes[0].x = -0.0; // equal, but not the same bits
        writer.write(stepWith(adding(4, SoftBodyDef{.mesh = std::make_shared<const geometry::TetMesh>(other)})));
    }
    const auto lines = file.records();
    REQUIRE(lines.size() == 1 + 4 + 2 + 1);
    CHECK_THAT(lines[0], Catch::StartsWith(R"({"filasofia":")"));
    CHECK_THAT(lines[0], Catch::EndsWith(R"(,"period":0.005,"contact":{"ExactContact":{"rounds":8,"tolerance":0.005}},)"
                                         R"("seed":0,"session":"","trainee":"","date":""})"));
    CHECK_THAT(lines[1], Catch::StartsWith(R"({"mesh":0,"nodes":4,"tetrahedra":1,"digest":")"));
    const std::size_t numbers = 4 * sizeof(Vec3) + sizeof(geometry::Tetrahedron);
    CHECK_THAT(lines[2].substr(numbers), Catch::StartsWith(R"({"dt":0.001,"commands":[)"));
    CHECK_THAT(lines[5], Catch::StartsWith(R"({"mesh":1,)"));
    CHECK(lines[7] == R"({"end":4})");
    const record::Recording recording = record::readRecording(file.path());
    CHECK(recording.header.period == 0.005);
    CHECK(recording.steps.size() == 4);
}

TEST_CASE("what was flushed can be read while the writer is still at work")
{
    const record::ScratchFile file("growing.rec");
    record::RecordingWriter writer(file.path(), {});
    for (std::size_t steps = 1; steps <= 3; ++steps) {
        writer.write(stepWith(Reset{}));
        writer.flush();
        const record::Recording so = record::readUpToDamage(file.path());
        CHECK(so.steps.size() == steps);
        CHECK_THAT(so.damage, Catch::Contains("before the end of the session; it is complete up to step 1"));
        CHECK_THROWS_WITH(record::readRecording(file.path()), so.damage);
    }
    writer.close();
    CHECK(record::readRecording(file.path()).steps.size() == 3);
}

TEST_CASE("a recording says when it cannot be written")
{
    CHECK_THROWS_WITH(record::RecordingWriter("/no/such/folder/a.rec", {}), "/no/such/folder/a.rec: cannot be written");
    record::RecordingWriter full("/dev/full", {});
    CHECK_THROWS_WITH(full.flush(), "/dev/full: cannot be written (disk full?)");
}

TEST_CASE("a recording names the build and the vector instructions that made it")
{
    const record::ScratchFile file("maker.rec");
    record::RecordingWriter(file.path(), {.simd = "AVX9", .period = 0.005}).close();
    const record::RecordingHeader header = record::RecordingReader(file.path()).header();
    CHECK_FALSE(header.filasofia.empty());
    CHECK_FALSE(header.revision.empty());
    CHECK(header.revision == record::sourceRevision());
    CHECK(header.simd == "AVX9");
    CHECK(header.period == 0.005);
}

TEST_CASE("the last bytes that a disk refuses are reported when a file is closed, and logged when it is only dropped")
{
    CHECK_THROWS_WITH(record::RecordingWriter("/dev/full", {}).close(), "/dev/full: cannot be written (disk full?)");
    std::vector<std::string> errors;
    setLogSink([&](LogLevel level, std::string_view line) {
        if (level == LogLevel::Error) errors.emplace_back(line);
    });
    record::RecordingWriter("/dev/full", {});
    setLogSink({});
    CHECK(errors == std::vector<std::string>{"/dev/full: cannot be written (disk full?)"});
}

TEST_CASE("a file has one writer, by whatever names it is opened, and is left as it is by the second")
{
    const record::ScratchFile file("one.rec"), symbolic("symbolic.rec"), hard("hard.rec");
    record::RecordingWriter first(file.path(), {});
    first.flush();
    const std::string before = file.bytes();
    std::filesystem::create_symlink(file.path(), symbolic.path());
    std::filesystem::create_hard_link(file.path(), hard.path());
    for (const auto& path : {file.path(), std::filesystem::relative(file.path()), symbolic.path(), hard.path()})
        CHECK_THROWS_WITH(record::RecordingWriter(path, {}),
                          path.string() + ": is already being written, under this or another name");
    CHECK(file.bytes() == before);
    first.close();
    record::RecordingWriter(hard.path(), {}).close(); // nobody writes it any more
    CHECK(record::readRecording(file.path()).steps.empty());
}

TEST_CASE("a recording that cannot be replayed to its end is logged once")
{
    std::vector<std::string> warnings;
    setLogSink([&](LogLevel, std::string_view line) { warnings.emplace_back(line); });
    const record::ScratchFile file("tuned.rec");
    {
        record::RecordingWriter writer(file.path(), {});
        StepRecord step = stepWith(Tune{[](PhysicsEngine&) {}});
        step.report.step = 12;
        step.report.set(StepFlag::Tuned);
        writer.write(step);
        writer.write(step);
    }
    setLogSink({});
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0] == file.name() + ": a replay will stop at step 12: tune() ran before it");
}

} // namespace recording_test
