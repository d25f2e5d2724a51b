#include "filasofia/core/error.h"
#include "filasofia/sofa/load.h"

// With and without SOFA.
namespace filasofia::sofaengine {

BodyId LoadedScene::body(const std::string& name) const
{
    const LoadedBody* found = nullptr;
    std::string known;
    for (const LoadedBody& each : bodies) {
        if (each.name == name) return each.id;
        known += text(known.empty() ? "'" : ", '", each.name, "'");
        if (!each.name.ends_with("/" + name)) continue;
        if (found) fail("scene of SOFA: '", name, "' is the end of '", found->name, "' and of '", each.name, "'");
        found = &each;
    }
    if (!found) fail("scene of SOFA: has no body '", name, "', but ", known.empty() ? "none" : known);
    return found->id;
}

} // namespace filasofia::sofaengine
