#include "filasofia/engine/contact/warm_start.h"

#include <catch2/catch.hpp>

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A contact of the bodies 1 and `second` that pushes along the normal.
void add(Coupling& coupling, Vec3 point, Vec3 normal, double gap, double push = 1.0, std::uint32_t second = 2)
{
    FoundContact contact;
    contact.memory.first = BodyId{1};
    contact.memory.second = BodyId{second};
    contact.memory.point = point;
    contact.gap = gap;
    coupling.contacts.push_back(contact);
    Link link;
    link.frame[0] = normal;
    link.next = {push, 0, 0};
    coupling.links.push_back(link);
}

} // namespace

TEST_CASE("contacts that push opposite ways at one place, deeper than they are apart, contradict each other")
{
    const Vec3 up = {0, 0, 1}, place = {0.01, 0.02, 0.03}, near = place + Vec3{0, 0, 20e-6};
    const auto judged = [&](auto change) {
        Coupling coupling;
        add(coupling, {-0.5, 0, 0}, up, -40e-6);
        add(coupling, place, up, -40e-6);
        add(coupling, near, -up, -39e-6);
        change(coupling);
        return contradicted(coupling);
    };
    CHECK(judged([](Coupling&) {}) == std::vector{false, true, true});
    const std::vector none(3, false);
    CHECK(judged([](Coupling& c) { c.contacts[2].gap = 1e-6; }) == none); // it does not overlap
    CHECK(judged([](Coupling& c) { c.links[1].next.x = 0.0; }) == none);  // does not push
    CHECK(judged([&](Coupling& c) { c.contacts[2].memory.point = place + 100e-6 * up; }) == none);
    CHECK(judged([&](Coupling& c) { c.links[2].frame[0] = up; }) == none);
    CHECK(judged([&](Coupling& c) { c.links[2].frame[0] = normalized(-up + Vec3{1, 0, 0}); }) == none);
    CHECK(judged([](Coupling& c) { c.contacts[2].memory.second = BodyId{3}; }) == none);
    // Of two others that have tissue between them, whichever of the two comes first.
    const auto pinched = [&](BodyPoint::Of what, bool first) {
        return judged([&](Coupling& c) {
            c.contacts[2].memory.second = BodyId{3};
            for (Link& link : c.links) link.sides[0].of = what;
            if (first) return;
            std::swap(c.contacts[2].memory.first, c.contacts[2].memory.second);
            std::swap(c.links[2].sides[0], c.links[2].sides[1]);
            c.links[2].frame[0] = up;
        });
    };
    for (const bool first : {true, false}) {
        CHECK(pinched(BodyPoint::Of::Soft, first) == std::vector{false, true, true});
        CHECK(pinched(BodyPoint::Of::Rigid, first) == none);
    }
    // Along the surface they may be some way apart, and neither the body nor its elements bend so sharply.
    CHECK(judged([&](Coupling& c) {
              c.contacts[2].memory.point = near + Vec3{0, 700e-6, 0};
          }) == std::vector{false, true, true});
    CHECK(judged([&](Coupling& c) { c.contacts[2].memory.point = near + Vec3{0, -800e-6, 0}; }) == none);
    CHECK(contradicted({}).empty());
}
