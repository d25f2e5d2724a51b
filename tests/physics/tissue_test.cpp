#include "filasofia/core/validate.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/tissue.h"

#include "geometry/sample_meshes.h"

#include <set>

namespace tissue_library_test {

using namespace filasofia;
using namespace filasofia::physics;
using Catch::Matchers::Contains;
using geometry::errorOf;

TEST_CASE("every tissue of the library is valid, has a source and a caveat, and lies in its published range")
{
    CHECK(tissues().size() >= 12);
    std::set<std::string_view> names;
    for (const Tissue& each : tissues()) {
        INFO(each.name);
        CHECK(names.insert(each.name).second);
        CHECK(&tissue(each.name) == &each);
        CHECK(errorOf([&] {
                  validate(each.material, "it");
                  check(each.material, "it");
              }).empty());
        CHECK(!each.title.empty());
        CHECK(each.source.size() > 20);
        CHECK(each.caveat.size() > 20);
        CHECK(each.density > 100.0);
        CHECK(each.lowest <= each.material.youngModulus);
        CHECK(each.material.youngModulus <= each.highest);
    }
}

TEST_CASE("a tissue that the library lacks is an error that lists the others")
{
    CHECK_THAT(errorOf([] { tissue("bone"); }), Contains("kidney, ligament, liver") && Contains("got 'bone'"));
}

} // namespace tissue_library_test
