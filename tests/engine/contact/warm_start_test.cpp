#include "filasofia/engine/contact/warm_start.h"

#include <catch2/catch.hpp>

namespace warm_start_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A contact of the bodies 1 and 2 with an impulse along the normal.
Constraint pushing(Vec3 point, Vec3 normal, double gap)
{
    Constraint contact;
    contact.contact.cached.first = BodyId{1};
    contact.contact.cached.second = BodyId{2};
    contact.contact.cached.point = point;
    contact.contact.gap = gap;
    contact.frame[0] = normal;
    contact.multiplier = {1.0, 0, 0};
    return contact;
}

using Contacts = std::vector<Constraint>;

} // namespace

TEST_CASE("contacts that push opposite ways at one place, deeper than their distance, contradict each other")
{
    const Vec3 up = {0, 0, 1}, place = {0.01, 0.02, 0.03}, near = place + Vec3{0, 0, 20e-6};
    const auto judged = [&](auto change) {
        Contacts contacts{pushing({-0.5, 0, 0}, up, -40e-6), pushing(place, up, -40e-6), pushing(near, -up, -39e-6)};
        change(contacts);
        return contradicted(contacts);
    };
    CHECK(judged([](Contacts&) {}) == std::vector{false, true, true});
    const std::vector none(3, false);
    CHECK(judged([](Contacts& c) { c[2].contact.gap = 1e-6; }) == none); // it does not overlap
    CHECK(judged([](Contacts& c) { c[1].multiplier.x = 0.0; }) == none); // no impulse
    CHECK(judged([&](Contacts& c) { c[2].contact.cached.point = place + 100e-6 * up; }) == none);
    CHECK(judged([&](Contacts& c) { c[2].frame[0] = up; }) == none);
    CHECK(judged([&](Contacts& c) { c[2].frame[0] = normalized(-up + Vec3{1, 0, 0}); }) == none);
    CHECK(judged([](Contacts& c) { c[2].contact.cached.second = BodyId{3}; }) == none);
    // Two other bodies with tissue between them contradict each other too, in either order.
    const auto pinched = [&](BodyPoint::Of what, bool first) {
        return judged([&](Contacts& c) {
            c[2].contact.cached.second = BodyId{3};
            for (Constraint& each : c) each.sides[0].of = what;
            if (first) return;
            std::swap(c[2].contact.cached.first, c[2].contact.cached.second);
            std::swap(c[2].sides[0], c[2].sides[1]);
            c[2].frame[0] = up;
        });
    };
    for (const bool first : {true, false}) {
        CHECK(pinched(BodyPoint::Of::Soft, first) == std::vector{false, true, true});
        CHECK(pinched(BodyPoint::Of::Rigid, first) == none);
    }
    // Along the surface they may be further apart, since neither the body nor its elements bend so sharply.
    CHECK(judged([&](Contacts& c) {
              c[2].contact.cached.point = near + Vec3{0, 700e-6, 0};
          }) == std::vector{false, true, true});
    CHECK(judged([&](Contacts& c) { c[2].contact.cached.point = near + Vec3{0, -800e-6, 0}; }) == none);
    CHECK(contradicted({}).empty());
}

} // namespace warm_start_test
