#include "filasofia/frame/frame.h"

namespace frame_test {

using namespace filasofia;
using namespace filasofia::frame;

TEST_CASE("a frame finds its bodies by id, and nothing for an id it does not hold")
{
    Frame frame;
    for (std::uint32_t id : {2u, 5u, 9u}) frame.softBodies.push_back({.id = BodyId{id}});
    for (std::uint32_t id : {1u, 7u}) frame.rigidBodies.push_back({.id = BodyId{id}});
    for (std::size_t i = 0; i < 3; ++i) CHECK(frame.softBody(frame.softBodies[i].id) == &frame.softBodies[i]);
    for (std::size_t i = 0; i < 2; ++i) CHECK(frame.rigidBody(frame.rigidBodies[i].id) == &frame.rigidBodies[i]);
    for (std::uint32_t id : {0u, 1u, 3u, 7u, 10u}) CHECK(frame.softBody(BodyId{id}) == nullptr);
    for (std::uint32_t id : {0u, 2u, 5u, 8u}) CHECK(frame.rigidBody(BodyId{id}) == nullptr);
}

TEST_CASE("an empty frame holds no body")
{
    CHECK(Frame{}.softBody(BodyId{1}) == nullptr);
    CHECK(Frame{}.rigidBody(BodyId{1}) == nullptr);
}

TEST_CASE("the force of contacts on a body: its own side of each, and one with itself adds nothing")
{
    constexpr BodyId a{1}, b{2}, c{3};
    const Contact ab{.first = a, .second = b, .normal = {0, 1, 0}, .normalForce = 2.0, .friction = {0.5, 0, 0}};
    const Contact ca{.first = c, .second = a, .normal = {0, 0, 1}, .normalForce = 3.0};
    const Contact aa{.first = a, .second = a, .normal = {1, 0, 0}, .normalForce = 7.0};
    CHECK(forceOn(a, ab) == Vec3{0.5, 2, 0});
    CHECK(forceOn(b, ab) == Vec3{-0.5, -2, 0});
    CHECK(forceOn(a, aa) == Vec3{7, 0, 0});
    CHECK(forceOn(a, std::vector{ab, ca, aa}) == Vec3{0.5, 2, -3});
    CHECK(forceOn(b, std::vector{ab, ca, aa}) == Vec3{-0.5, -2, 0});
    CHECK(forceOn(BodyId{9}, std::vector{ab, ca, aa}) == Vec3{});
}

TEST_CASE("attachments between bodies exert a force on both, and attachments to space do not count")
{
    const std::vector<frame::Attachment> attachments = {{.id = {1}, .body = {2}, .to = {1}, .force = {0, 3, 0}},
                                                        {.id = {2}, .body = {1}, .to = {}, .force = {9, 0, 0}},
                                                        {.id = {3}, .body = {2}, .to = {5}, .force = {0, 0, 7}},
                                                        {.id = {4}, .body = {2}, .to = {2}, .force = {5, 5, 5}}};
    CHECK(frame::forceOn({1}, attachments) == Vec3{0, -3, 0});
    CHECK(frame::forceOn({2}, attachments) == Vec3{0, 3, 7});
    CHECK(frame::forceOn({5}, attachments) == Vec3{0, 0, -7});
    CHECK(frame::forceOn({6}, attachments) == Vec3{});
}

} // namespace frame_test
