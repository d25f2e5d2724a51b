#include "filasofia/runtime/engines.h"

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/core/word.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/sofa/sofa_engine.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

/// An engine, and how it is made.
struct NamedEngine {
    const char* name;
    bool repeatable; ///< known without making it: the program that replays may lack it
    std::unique_ptr<physics::PhysicsEngine> (*make)(const EngineDef&);
};

const NamedEngine kEngines[] = {
    {"native", true,
     [](const EngineDef& def) {
         return engine::makeNativeEngine({.period = def.period, .threads = def.threads, .contact = def.contact});
     }},
    {"sofa", false,
     [](const EngineDef& def) { return sofaengine::makeSofaEngine({.period = def.period, .contact = def.contact}); }},
};

const NamedEngine& engineOf(const std::string& name)
{
    const auto* found = std::ranges::find(kEngines, name, &NamedEngine::name);
    if (found != std::end(kEngines)) return *found;
    std::string known;
    for (const NamedEngine& each : kEngines) known += text(known.empty() ? "" : " or ", each.name);
    fail("engine must be ", known, ", got ", shownWord(name), didYouMean(name, engineNames()));
}

} // namespace

std::vector<std::string> engineNames()
{
    std::vector<std::string> names;
    for (const NamedEngine& each : kEngines) names.emplace_back(each.name);
    return names;
}

std::unique_ptr<physics::PhysicsEngine> makeEngine(const std::string& name, const EngineDef& def)
{
    return engineOf(name).make(def);
}

std::unique_ptr<physics::PhysicsEngine> makeReplayEngine(const record::RecordingHeader& header, const std::string& file,
                                                         std::optional<int> threads)
{
    const auto* known = std::ranges::find(kEngines, header.engine, &NamedEngine::name);
    if (known == std::end(kEngines) || !known->repeatable)
        fail(file, ": was recorded with the engine ", shownWord(header.engine),
             ", which does not repeat its steps bit for bit: only a recording of the native engine can be replayed");
    return known->make({.period = header.period, .threads = threads, .contact = header.contact});
}

} // namespace filasofia::runtime
