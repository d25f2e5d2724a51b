#include "filasofia/scene/import.h"

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/scene/mjcf_flex.h"
#include "filasofia/scene/mjcf_sensors.h"
#include "filasofia/visual/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace filasofia::scene {
namespace {

/// Reads a whole model: its sections in the order in which one needs the other.
class MjcfLoader {
public:
    MjcfLoader(const std::filesystem::path& file, const ImportOptions& options)
        : source_(file, options), reader_(source_.reader), bodies_(source_), flexes_(source_, bodies_)
    {
    }

    Imported load()
    {
        checkSections();
        readOption();
        readBodies();
        readEqualities();
        readActuators();
        std::vector<SceneBody> soft;
        for (const MjcfPending& each : bodies_.flexes)
            if (auto body = flexes_.read(each)) soft.push_back(std::move(*body));
        addTrees();
        for (SceneBody& each : soft) addSoft(std::move(each));
        out_.scene.sensors = MjcfSensors(source_, bodies_, bodyOf_).read();
        noteFriction();
        readPicture();
        out_.scene.files = reader_.files();
        out_.notes = reader_.takeNotes();
        return std::move(out_);
    }

private:
    void checkSections()
    {
        const std::vector<std::string> known = {"compiler", "option",   "default",   "asset", "worldbody",
                                                "actuator", "equality", "statistic", "sensor"};
        for (const Element& each : source_.childrenOf(source_.root()))
            if (std::ranges::find(known, each.tag()) == known.end())
                reader_.tell(each, text("<", each.tag()),
                             text("<", text(each.tag()).substr(0, 80), "> is not read", didYouMean(each.tag(), known)));
    }

    void readOption()
    {
        double step = 0.002;
        Vec3 gravity{0, 0, -9.81};
        for (const Element& each : source_.sections("option")) {
            reader_.tellUnread(each, {"timestep", "gravity"});
            for (const Element& inner : source_.childrenOf(each)) reader_.tellUnread(inner);
            const Attributes says(each);
            step = reader_.number(says, "timestep", step, closed(1e-5, 1));
            gravity = reader_.vector(says, "gravity", gravity, closed(-1e6, 1e6));
        }
        out_.scene.physics.rate = 1.0 / step;
        out_.scene.physics.gravity = {gravity.x, gravity.z, -gravity.y};
    }

    void readBodies()
    {
        const std::vector<Element> found = source_.sections("worldbody");
        if (found.empty()) reader_.refuse(source_.root(), "must have a <worldbody>");
        for (const Element& each : found) bodies_.read(each);
    }

    void readActuators()
    {
        for (const Element& section : source_.sections("actuator"))
            for (const Element& each : source_.childrenOf(section)) {
                const bool general = each.tag() == "general", goes = each.tag() == "position";
                const Attributes says = source_.attributesOf(each, {});
                const auto joint = says.find("joint");
                if ((!goes && !general && each.tag() != "motor") || !joint) {
                    reader_.tell(each, text("actuator ", each.tag()),
                                 joint ? text("<", each.tag(), "> is not read")
                                       : text("<", each.tag(), "> of something else than a joint is not read"));
                    continue;
                }
                const Joint at = jointNamed(*joint);
                if (joined_.contains(at))
                    reader_.tell(each, "actuator of joint1",
                                 text("<", each.tag(), "> of a joint1 of <equality> is not read: joint2 moves it"));
                else if (goes || general)
                    drive(at, says, general ? generalSpring(says) : positionSpring(says));
                if (const std::string name = reader_.word(says, "name"); !name.empty())
                    bodies_.actuators.emplace(name, at);
            }
    }
    using Joint = std::pair<std::size_t, std::size_t>; ///< the number of its body, and its number there
    [[nodiscard]] Joint jointNamed(const Attribute& name) const
    {
        return reader_.named(name, bodies_.joints, "must be the name of a hinge or a slide");
    }

    // The springs of actuators whose control is 0 until something is commanded, in lengths and forces before the gear.
    [[nodiscard]] physics::JointSpring positionSpring(const Attributes& says) const
    {
        return {.stiffness = reader_.number(says, "kp", 1.0, closed(0, 1e12)),
                .damping = reader_.number(says, "kv", 0.0, closed(0, 1e12))};
    }
    /// With the control u a <general> pulls with gain u + bias[0] + bias[1] q + bias[2] q'. Nothing if it is a motor,
    /// or not read.
    [[nodiscard]] std::optional<physics::JointSpring> generalSpring(const Attributes& says)
    {
        const std::size_t type = reader_.oneOf(says, "biastype", 0, {"none", "affine", "muscle", "user"});
        if (type > 1) {
            reader_.tell(says.element(), "biastype", "<general> is read with biastype none or affine");
            return {};
        }
        if (type == 0) {
            reader_.tellUnread(says.element(),
                               {"name", "class", "joint", "gainprm", "gaintype", "biastype", "biasprm"});
            return {};
        }
        std::vector<double> bias;
        if (const auto found = says.find("biasprm")) bias = reader_.numbers(*found, 1, 10, closed(-1e12, 1e12));
        bias.resize(3);
        if (bias[1] > 0.0 || bias[2] > 0.0) {
            reader_.tell(says.element(), "biasprm", "<general> whose bias drives it away is not read");
            return {};
        }
        if (bias[0] != 0.0 && bias[1] == 0.0)
            reader_.tell(says.element(), "constant force",
                         "the constant force of a <general> without stiffness is not read");
        return physics::JointSpring{
            .value = bias[1] < 0.0 ? bias[0] / -bias[1] : 0.0, .stiffness = -bias[1], .damping = -bias[2]};
    }
    /// Gives a joint the spring of its actuator, through its gear. A motor leaves the joint as it is: its force is 0.
    void drive(const Joint& at, const Attributes& says, std::optional<physics::JointSpring> spring)
    {
        if (!spring) return;
        physics::JointDef& def = bodies_.trees[at.first].def.articulation.joints[at.second];
        double gear = 1.0;
        if (const auto found = says.find("gear")) gear = reader_.numbers(*found, 1, 6, closed(-1e6, 1e6))[0];
        if (std::holds_alternative<physics::JointSpring>(*def.command))
            reader_.tell(
                says.element(), "second spring",
                "the stiffness of a <joint> that has an actuator with one is not read, nor is a second such actuator");
        spring->value = gear != 0.0 ? spring->value / gear : 0.0;
        spring->stiffness *= gear * gear;
        spring->damping *= gear * gear;
        if (const auto limit = forceLimit(says)) spring->strength = std::abs(gear) * *limit;
        def.command = *spring;
    }
    /// [N m] or [N] before the gear.
    [[nodiscard]] std::optional<double> forceLimit(const Attributes& says)
    {
        const auto range = says.find("forcerange");
        const std::size_t limited = reader_.oneOf(says, "forcelimited", 2, {"false", "true", "auto"});
        if (!range) {
            if (limited == 1) reader_.refuse(says.element(), "must say its forcerange, because it is limited");
            return {};
        }
        const std::vector<double> v = reader_.numbers(*range, 2, 2, closed(-1e12, 1e12));
        if (v[0] > v[1]) reader_.refuse(*range, "must be ascending");
        if (limited == 0 || (limited == 2 && !(source_.compiler.autoLimits && v[0] < v[1]))) return {};
        if (v[0] != -v[1])
            reader_.note(says.element(), "forcerange",
                         "forcerange is read as the larger of its two forces, in both directions");
        return std::max(std::abs(v[0]), std::abs(v[1]));
    }

    void readEqualities()
    {
        for (const Element& section : source_.sections("equality"))
            for (const Element& each : source_.childrenOf(section)) {
                if (each.tag() == "joint")
                    follow(each);
                else
                    reader_.tell(each, text("equality ", each.tag()),
                                 text("<", text(each.tag()).substr(0, 80), "> of <equality> is not read"));
            }
    }
    /// A joint that is a polynomial of another one, or of nothing: y - y0 = a0 + a1 (x - x0), from where both are in
    /// the file.
    void follow(const Element& equality)
    {
        reader_.tellUnread(equality, {"name", "class", "joint1", "joint2", "polycoef", "active"});
        const Attributes says(equality);
        if (!reader_.flag(says, "active", true)) return;
        const auto first = says.find("joint1"), second = says.find("joint2"), polynomial = says.find("polycoef");
        if (!first) reader_.refuse(equality, "must say its joint1");
        std::vector<double> a = {0.0, 1.0, 0.0, 0.0, 0.0};
        if (polynomial) std::ranges::copy(reader_.numbers(*polynomial, 1, 5, closed(-1e6, 1e6)), a.begin());
        const auto [tree, joint] = jointNamed(*first);
        const auto other = second ? jointNamed(*second) : std::pair(tree, joint);
        if (other.first != tree || (second && other.second == joint))
            reader_.refuse(*second, "must be another joint of the same body");
        physics::JointDef& def = bodies_.trees[tree].def.articulation.joints[joint];
        if (std::holds_alternative<physics::JointSpring>(*def.command))
            reader_.tell(equality, "stiffness of joint1", "the stiffness of a joint1 of <equality> is not read");
        if (a[2] != 0.0 || a[3] != 0.0 || a[4] != 0.0)
            reader_.tell(equality, "polycoef",
                         "<joint> of <equality> follows in proportion: higher powers are not read");
        if (!joined_.insert({tree, joint}).second)
            reader_.refuse(*first, "must be a joint that no other <equality> has for its joint1");
        const double from = bodies_.references.at({tree, joint});
        if (second)
            bodies_.trees[tree].mimics.push_back({.joint = joint,
                                                  .way = {.joint = static_cast<int>(other.second),
                                                          .multiplier = a[1],
                                                          .offset = from + a[0] - a[1] * bodies_.references.at(other)},
                                                  .at = equality});
        else
            def.command = physics::JointPosition{std::clamp(from + a[0], def.lower, def.upper)};
    }

    void addTrees()
    {
        bodyOf_.resize(bodies_.trees.size());
        for (std::size_t t = 0; t < bodies_.trees.size(); ++t) {
            RigidTree& tree = bodies_.trees[t];
            if (!tree.isMoved() && tree.show.empty() && tree.def.collision.empty()) continue;
            tree.def.name = names_.take(tree.def.name);
            touchItself(tree);
            if (tree.def.dynamic && !(tree.inertias[0].mass > 0.0))
                reader_.refuse(tree.place, "must have a mass, because it moves freely");
            out_.scene.bodies.push_back(tree.finish(reader_));
            out_.joints.push_back(tree.jointNames);
            bodyOf_[t] = BodyId{static_cast<std::uint32_t>(out_.scene.bodies.size())};
        }
    }
    /// Lets links touch each other, except those with a joint between them: MuJoCo leaves out a body and its parent.
    /// A body with several joints is farther from its parent than one joint, and would touch it all the time.
    void touchItself(RigidTree& tree)
    {
        if (tree.links() < 2 || tree.def.collision.empty() || (tree.types & tree.affinities) == 0) return;
        if (tree.manyJoints) {
            reader_.note(tree.place, "self", "links do not touch each other if one of them has several joints");
            return;
        }
        for (physics::CollisionDef& each : tree.def.collision) each.self = true;
    }

    /// Two bodies rub with the root of the product of their frictions; in MuJoCo with the larger of both.
    void noteFriction()
    {
        double least = std::numeric_limits<double>::infinity(), most = 0.0;
        for (const SceneBody& each : out_.scene.bodies)
            std::visit(
                [&](const auto& def) {
                    if constexpr (requires { def.collision.empty(); }) {
                        if (def.collision.empty()) return;
                        least = std::min(least, def.friction);
                        most = std::max(most, def.friction);
                    }
                },
                each.def);
        if (least < most)
            reader_.note(source_.root(), "friction of pairs",
                         text("bodies have frictions from ", least, " to ", most,
                              ": two of them rub with the root of their product, in MuJoCo with the larger one"));
    }

    void addSoft(SceneBody body)
    {
        auto& def = std::get<physics::SoftBodyDef>(body.def);
        keepUnit(def.pose.orientation);
        def.name = names_.take(def.name);
        for (physics::AttachmentDef& each : def.attachments)
            if (each.to) each.to = bodyOf_[each.to.value - 1];
        out_.scene.bodies.push_back(std::move(body));
        out_.joints.emplace_back();
    }

    void readPicture()
    {
        geometry::Box around = merged(bodies_.bounds(), flexes_.bounds());
        for (const Element& each : source_.sections("statistic")) {
            reader_.tellUnread(each, {"center", "extent"});
            const Attributes says(each);
            if (!says.has("center") && !says.has("extent")) continue;
            const Vec3 standard = isEmpty(around) ? Vec3{} : 0.5 * (around.low + around.high);
            const Vec3 back{standard.x, -standard.z, standard.y};
            const Vec3 c = reader_.vector(says, "center", back, closed(-kFarthestShape, kFarthestShape));
            const double extent = reader_.number(says, "extent", 1.0, closed(1e-6, kFarthestShape));
            const Vec3 middle{c.x, c.z, -c.y}, half{0.5 * extent, 0.5 * extent, 0.5 * extent};
            around = {middle - half, middle + half};
        }
        if (!isEmpty(around)) out_.scene.look.around = around;
        out_.scene.look.direction = {0.5, 0.4, 1.0};
        // The first camera is the picture, so those that stand still come first; a model may have eyes of its own.
        const auto moves = [&](const MjcfPending& each) { return bodies_.trees[each.place.tree].isMoved(); };
        std::stable_partition(bodies_.cameras.begin(), bodies_.cameras.end(),
                              [&](const MjcfPending& each) { return !moves(each); });
        for (const MjcfPending& each : bodies_.cameras) {
            if (moves(each) && out_.scene.cameras.empty())
                reader_.tell(each.element, "moving camera",
                             "a <camera> that moves is not read without one that stands still");
            else
                readCamera(each);
        }
        for (const MjcfPending& each : bodies_.lights) readLight(each);
    }

    /// Lets a camera or a light stand where its element does, or move with its body.
    template <class Def> void put(const MjcfPending& at, const Pose& pose, Placed<Def>& placed)
    {
        if (bodies_.trees[at.place.tree].isMoved()) {
            placed.follow =
                SceneFollow{{runtime::FollowElement{at.place.link}, at.place.pose * pose}, bodyOf_[at.place.tree]};
            return;
        }
        placed.pose = bodies_.worldPose(at.place) * pose;
    }

    void readCamera(const MjcfPending& at)
    {
        const Attributes says = source_.attributesOf(at.element, at.place.childClass);
        const auto mode = says.find("mode");
        if (mode && mode->words != "fixed") {
            reader_.tell(at.element, "camera mode", "<camera> is read only with mode=\"fixed\"");
            return;
        }
        SceneCamera camera;
        const std::string name = reader_.word(says, "name");
        camera.def.name = cameraNames_.take(name.empty() ? "camera" : name);
        camera.def.verticalFieldOfView =
            reader_.number(says, "fovy", 45.0, closed(0.6, 170)) * std::numbers::pi / 180.0;
        const geometry::Box around = out_.scene.look.around.value_or(geometry::Box{{-1, -1, -1}, {1, 1, 1}});
        const double size = std::max(length(around.high - around.low), 1e-3);
        camera.def.near = 0.005 * size;
        camera.def.far = 100.0 * size;
        camera.def.focusDistance = size;
        put(at, source_.poseOf(says), camera);
        out_.scene.cameras.push_back(std::move(camera));
    }

    void readLight(const MjcfPending& at)
    {
        if (out_.scene.cameras.empty()) {
            reader_.tell(at.element, "light",
                         "<light> is not read without a <camera>: the picture has a light of its own");
            return;
        }
        const Attributes says = source_.attributesOf(at.element, at.place.childClass);
        if (const auto mode = says.find("mode"); mode && mode->words != "fixed")
            return reader_.tell(at.element, "light mode", "<light> is read only with mode=\"fixed\"");
        SceneLight light;
        reader_.refuseSecond(at.element, {"type", "directional"});
        const std::size_t type = reader_.oneOf(says, "type", 0, {"spot", "directional", "point", "image"});
        if (type > 1) return reader_.tell(at.element, "light type", "<light> is read only as a spot or directional");
        const bool directional = reader_.flag(says, "directional", false) || type == 1;
        const bool other = std::ranges::any_of(out_.scene.lights, [](const SceneLight& each) {
            return std::holds_alternative<visual::DirectionalLight>(each.def.kind);
        });
        if (directional && other) {
            reader_.tell(at.element, "second light", "a second directional <light> is not read");
            return;
        }
        const geometry::Box around = out_.scene.look.around.value_or(geometry::Box{{-1, -1, -1}, {1, 1, 1}});
        const Vec3 pos = reader_.vector(says, "pos", {}, closed(-kFarthestShape, kFarthestShape));
        const double range = std::max(length(around.high - around.low) + length(pos), 1e-3);
        if (directional)
            light.def.kind = visual::DirectionalLight{};
        else
            light.def.kind = visual::SpotLight{.intensity = 5000.0 * range * range, .range = 4.0 * range};
        shadows_ += directional ? 0 : 1;
        light.def.castShadows = reader_.flag(says, "castshadow", true) && (directional || shadows_ <= 2);
        const std::string name = reader_.word(says, "name");
        light.def.name = lightNames_.take(name.empty() ? "light" : name);
        const Vec3 dir = reader_.vector(says, "dir", {0, 0, -1}, closed(-1e6, 1e6));
        if (!(length(dir) > 1e-9)) reader_.refuse(at.element, "must have a dir of some length");
        const Vec3 up = std::abs(normalized(dir).z) > 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
        put(at, visual::lookAt(pos, pos + normalized(dir), up), light);
        out_.scene.lights.push_back(std::move(light));
    }

    MjcfSource source_;
    XmlReader& reader_;
    MjcfBodies bodies_;
    MjcfFlex flexes_;
    Imported out_;
    std::vector<BodyId> bodyOf_; ///< each tree's body; none if it has nothing to show, touch or move
    std::set<std::pair<std::size_t, std::size_t>> joined_; ///< joints that an equality moves or holds
    Names names_, cameraNames_, lightNames_;
    int shadows_ = 0;
};

} // namespace

Imported loadMjcf(const std::filesystem::path& file, const ImportOptions& options)
{
    return MjcfLoader(file, options).load();
}

} // namespace filasofia::scene
