#include "filasofia/engine/articulation/link_motion.h"

#include "filasofia/engine/integration/rigid.h"
#include "filasofia/math/world_inertia.h"

#include "engine/meshes.h"

#include <array>
#include <numbers>

namespace link_motion_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kPi = std::numbers::pi;

/// Six joints of both kinds with arbitrary offsets, in two branches.
LinkTree branchedTree(std::mt19937& random)
{
    std::vector<LinkJoint> joints(6);
    const std::array<int, 6> parents{0, 1, 1, 3, 4, 2};
    for (std::size_t j = 0; j < joints.size(); ++j) {
        joints[j].prismatic = j == 1 || j == 4;
        joints[j].axis = normalized(randomVec3(random, 1.0));
        joints[j].parent = parents[j];
        joints[j].child = static_cast<int>(j) + 1;
        joints[j].parentOffset = {randomVec3(random, 0.3), randomRotation(random)};
        joints[j].childOffset = {randomVec3(random, 0.3), randomRotation(random)};
        joints[j].inertia = 0.01 * static_cast<double>(j);
    }
    return linkTree(std::move(joints));
}

struct Links {
    LinkTree tree;
    std::vector<Pose> poses;
    std::vector<JointAxis> axes;
    Links(LinkTree made, const Pose& base, const std::vector<double>& q) : tree(std::move(made)), poses(7, base)
    {
        placeLinks(tree, q, poses);
        axes = jointAxes(tree, poses);
    }
};

/// Mass, centre and inertia of a link in its own coordinates.
struct Body {
    double mass;
    Vec3 centre;
    Mat3 inertia;
};
std::vector<Body> bodies(std::mt19937& random)
{
    std::vector<Body> all;
    for (int i = 0; i < 7; ++i) {
        const Mat3 root = randomMat3(random, 0.2);
        const Mat3 moments = root * transpose(root) + Mat3::diagonal({0.01, 0.02, 0.015});
        all.push_back({0.5 + 0.1 * i, randomVec3(random, 0.1), moments});
    }
    return all;
}
std::vector<LinkMass> massesAt(const std::vector<Body>& all, const std::vector<Pose>& poses)
{
    std::vector<LinkMass> masses;
    for (std::size_t i = 0; i < all.size(); ++i)
        masses.push_back(
            {all[i].mass, transform(poses[i], all[i].centre), worldInertia(all[i].inertia, poses[i].orientation)});
    return masses;
}

const std::vector<double> kQ{0.3, -0.11, 1.2, -0.7, 0.23, 2.1};
const std::vector<double> kRate{1.1, 0.4, -0.8, 0.5, -0.3, 0.9};
const std::vector<int> kAll{0, 1, 2, 3, 4, 5};

} // namespace

TEST_CASE("forward poses of a chain of six joints, one of them prismatic, match the closed form")
{
    // The Stanford arm (Paul, Robot Manipulators, 1981, section 2.10) in the convention of Denavit and Hartenberg:
    // after the joint about or along z come a translation d along z and a rotation alpha about x.
    const double d2 = 0.1524;
    const std::array<double, 6> alpha{-kPi / 2, kPi / 2, 0, -kPi / 2, kPi / 2, 0}, d{0, d2, 0, 0, 0, 0};
    std::vector<LinkJoint> joints(6);
    for (std::size_t j = 0; j < 6; ++j) {
        joints[j].prismatic = j == 2;
        joints[j].parent = static_cast<int>(j);
        joints[j].child = static_cast<int>(j) + 1;
        joints[j].childOffset = inverse(Pose{{0, 0, d[j]}, axisAngle({1, 0, 0}, alpha[j])});
    }
    const LinkTree tree = linkTree(joints);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> angle(-kPi, kPi);
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<double> q(6);
        for (double& each : q) each = angle(random);
        std::vector<Pose> poses(7);
        placeLinks(tree, q, poses);

        const auto s = [&](std::size_t i) { return std::sin(q[i - 1]); };
        const auto c = [&](std::size_t i) { return std::cos(q[i - 1]); };
        const double d3 = q[2];
        const double u = c(4) * c(5) * c(6) - s(4) * s(6), v = s(4) * c(5) * c(6) + c(4) * s(6);
        const double m = c(4) * c(5) * s(6) + s(4) * c(6), w = -s(4) * c(5) * s(6) + c(4) * c(6);
        const Vec3 n{c(1) * (c(2) * u - s(2) * s(5) * c(6)) - s(1) * v,
                     s(1) * (c(2) * u - s(2) * s(5) * c(6)) + c(1) * v, -s(2) * u - c(2) * s(5) * c(6)};
        const Vec3 o{c(1) * (-c(2) * m + s(2) * s(5) * s(6)) - s(1) * w,
                     s(1) * (-c(2) * m + s(2) * s(5) * s(6)) + c(1) * w, s(2) * m + c(2) * s(5) * s(6)};
        const double e = c(2) * c(4) * s(5) + s(2) * c(5);
        const Vec3 a{c(1) * e - s(1) * s(4) * s(5), s(1) * e + c(1) * s(4) * s(5), -s(2) * c(4) * s(5) + c(2) * c(5)};
        const Vec3 p{c(1) * s(2) * d3 - s(1) * d2, s(1) * s(2) * d3 + c(1) * d2, c(2) * d3};

        const Mat3 turn = toMat3(poses[6].orientation);
        CHECK(frobeniusNorm(turn - Mat3::columns(n, o, a)) < 1e-12);
        CHECK(length(poses[6].position - p) < 1e-12);
    }
}

TEST_CASE("the columns of the Jacobian and the velocities of links match finite differences of positions")
{
    std::mt19937 random(5);
    const LinkTree tree = branchedTree(random);
    const Pose base{{0.1, -0.2, 0.3}, randomRotation(random)};
    const Links links(tree, base, kQ);
    const Vec3 point = randomVec3(random, 0.4);
    constexpr double h = 1e-6;
    const auto way = [&](const Pose& before, const Pose& after, Vec3 at) {
        return (0.5 / h) * (transform(after, at) - transform(before, at));
    };
    std::vector<LinkJoint> coupled = tree.joints;
    coupled[4].mimics = 0, coupled[4].multiplier = -0.7; // further out on the same path
    coupled[5].mimics = 3, coupled[5].multiplier = 1.3;  // on another one
    for (const LinkTree& each : {tree, linkTree(coupled)})
        for (int j = 0; j < 6; ++j) {
            if (each.joints[static_cast<std::size_t>(j)].mimics >= 0) continue;
            std::vector<double> less = kQ, more = kQ;
            addVelocities(each, std::array{j}, std::array{-h}, less);
            addVelocities(each, std::array{j}, std::array{h}, more);
            const Links before(each, base, less), after(each, base, more);
            for (int link = 1; link < 7; ++link) {
                const auto l = static_cast<std::size_t>(link);
                const Vec3 there = transform(links.poses[l], point);
                const LinkMotion column = columnAt(each, links.axes, j, link, there);
                const bool moved = moves(each, j, link);
                CHECK(length(way(before.poses[l], after.poses[l], point) - (moved ? column.linear : Vec3{})) < 1e-8);
                const Quat turn = after.poses[l].orientation * conjugate(before.poses[l].orientation);
                CHECK(length((0.5 / h) * rotationVector(turn) - (moved ? column.angular : Vec3{})) < 1e-8);
            }
        }

    const LinkMotion of{{0.3, 0.1, -0.5}, {0.7, -1.1, 0.2}}; // the base's motion
    std::vector<LinkMotion> motion(7, of);
    moveLinks(tree, links.axes, links.poses, kRate, motion);
    const auto at = [&](double t) {
        std::vector<double> q = kQ;
        for (std::size_t j = 0; j < 6; ++j) q[j] += t * kRate[j];
        return Links(tree, moved(base, {}, of.linear, of.angular, t), q);
    };
    const Links before = at(-h), after = at(h);
    for (std::size_t l = 1; l < 7; ++l) {
        CHECK(length(way(before.poses[l], after.poses[l], {}) - motion[l].linear) < 1e-8);
        const Quat turn = after.poses[l].orientation * conjugate(before.poses[l].orientation);
        CHECK(length((0.5 / h) * rotationVector(turn) - motion[l].angular) < 1e-8);
    }
}

TEST_CASE("the reduced mass matrix matches the kinetic energy of links and drives, and its inverse is correct")
{
    std::mt19937 random(7);
    const Links links(branchedTree(random), Pose{}, kQ);
    const std::vector<LinkMass> masses = massesAt(bodies(random), links.poses);
    const JointMatrix m = massMatrix(links.tree, links.axes, masses, kAll);

    std::vector<LinkMotion> motion(7);
    moveLinks(links.tree, links.axes, links.poses, kRate, motion);
    double energy = 0.0;
    for (std::size_t l = 1; l < 7; ++l) {
        const Vec3 w = motion[l].angular, v = motion[l].linear + cross(w, masses[l].centre - links.poses[l].position);
        energy += 0.5 * masses[l].mass * dot(v, v) + 0.5 * dot(w, masses[l].inertia * w);
    }
    for (std::size_t j = 0; j < 6; ++j) energy += 0.5 * links.tree.joints[j].inertia * kRate[j] * kRate[j];
    std::vector<double> momentum(6);
    multiply(m, kRate, momentum);
    double reduced = 0.0;
    for (std::size_t j = 0; j < 6; ++j) reduced += 0.5 * kRate[j] * momentum[j];
    CHECK(reduced == Approx(energy).epsilon(1e-13));

    std::vector<double> back(6);
    multiply(inverse(m), momentum, back);
    for (std::size_t j = 0; j < 6; ++j) CHECK(back[j] == Approx(kRate[j]).epsilon(1e-11));

    const JointMatrix part = massMatrix(links.tree, links.axes, masses, std::vector<int>{1, 3});
    CHECK((part(0, 0) == m(1, 1) && part(1, 0) == m(3, 1) && part(0, 1) == m(1, 3) && part(1, 1) == m(3, 3)));
}

TEST_CASE("inverse dynamics matches the Newton-Euler equations of every link")
{
    std::mt19937 random(9);
    const LinkTree tree = branchedTree(random);
    const std::vector<Body> all = bodies(random);
    const std::vector<double> gain{0.7, -1.3, 0.4, 2.0, -0.6, 1.5};
    const Pose base{{0.1, -0.2, 0.3}, randomRotation(random)};
    const LinkMotion going{{0.3, 0.1, -0.5}, {0.7, -1.1, 0.2}}, gaining{{1.0, -2.0, 0.5}, {}};
    const Vec3 gravity{0.3, -9.81, 1.0};

    const auto at = [&](double t) {
        std::vector<double> q = kQ;
        for (std::size_t j = 0; j < 6; ++j) q[j] += t * kRate[j] + 0.5 * t * t * gain[j];
        Pose there = moved(base, {}, going.linear, going.angular, t);
        there.position += 0.5 * t * t * gaining.linear;
        return Links(tree, there, q);
    };
    const Links now = at(0.0);
    const std::vector<LinkMass> masses = massesAt(all, now.poses);
    const std::vector<double> forces =
        inverseDynamics({tree, now.axes, now.poses, masses, kRate, gain, going, gaining}, gravity, kAll);

    // Momentum by finite differences of positions over h, its change by finite differences of momentum.
    constexpr double h = 1e-4;
    const Links before = at(-h), after = at(h);
    std::vector<double> expected(6);
    for (std::size_t j = 0; j < 6; ++j) expected[j] = tree.joints[j].inertia * gain[j];
    for (std::size_t l = 1; l < 7; ++l) {
        const auto centre = [&](const Links& links) { return transform(links.poses[l], all[l].centre); };
        const Vec3 acceleration = (1.0 / (h * h)) * (centre(before) - 2.0 * centre(now) + centre(after));
        const auto spin = [&](const Links& a, const Links& b) {
            const Quat turn = b.poses[l].orientation * conjugate(a.poses[l].orientation);
            const Vec3 w = (1.0 / h) * rotationVector(turn);
            const Quat half = axisAngle(0.5 * h * w, 0.5 * h * length(w)) * a.poses[l].orientation;
            return worldInertia(all[l].inertia, half) * w;
        };
        const Vec3 force = all[l].mass * (acceleration - gravity);
        const Vec3 torque = (1.0 / h) * (spin(now, after) - spin(before, now));
        for (int j = 0; j < 6; ++j) {
            if (!moves(tree, j, static_cast<int>(l))) continue;
            const LinkMotion column = columnAt(tree, now.axes, j, static_cast<int>(l), centre(now));
            expected[static_cast<std::size_t>(j)] += dot(column.linear, force) + dot(column.angular, torque);
        }
    }
    for (std::size_t j = 0; j < 6; ++j) CHECK(forces[j] == Approx(expected[j]).margin(1e-5));
}

TEST_CASE("joints that form no tree are refused, and a tree is accepted in any order of joints")
{
    std::vector<LinkJoint> joints(3);
    const auto tie = [&](std::size_t j, int parent, int child) {
        joints[j].parent = parent;
        joints[j].child = child;
    };
    tie(0, 2, 3), tie(1, 0, 2), tie(2, 3, 1);
    const LinkTree tree = linkTree(joints);
    CHECK(tree.order == std::vector<int>{1, 0, 2});
    CHECK(tree.jointOf == std::vector<int>{-1, 2, 1, 0});
    CHECK(moves(tree, 1, 1));
    CHECK_FALSE(moves(tree, 2, 3));
    checkTree("tool", tree);
    tie(1, 1, 2); // 1, 2 and 3 in a ring
    CHECK_THROWS_WITH(checkTree("tool", linkTree(joints)), Catch::Contains("tool: joints must form a tree"));
}

} // namespace link_motion_test
