#include "filasofia/frame/frame.h"

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
