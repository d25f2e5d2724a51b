#include "filasofia/sofa/loaded_graph.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/sofa/shown_model.h"
#include "filasofia/sofa/sofa_process.h"

#include <sofa/core/ObjectFactory.h>
#include <sofa/core/behavior/BaseMechanicalState.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/helper/system/FileSystem.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/UpdateMappingVisitor.h>

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <filesystem>
#include <set>
#include <sstream>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::behavior::BaseMechanicalState;
using ::sofa::simulation::Node;
namespace system = ::sofa::helper::system;

/// The type in a message that says that SOFA could not make a component; empty in any other.
std::string missingType(const std::string& message)
{
    constexpr std::string_view begin = "Object type ", end = " was not created";
    const std::size_t at = message.find(begin), stop = message.find(end);
    if (at == std::string::npos || stop == std::string::npos || stop < at) return {};
    std::string type = message.substr(at + begin.size(), stop - at - begin.size());
    return type.substr(0, type.find('<'));
}

/// Components that only SOFA's own window needs.
bool isForItsWindow(const std::string& type)
{
    const auto has = [&](const char* part) { return type.find(part) != std::string::npos; };
    return type.starts_with("Ogl") || type.starts_with("Visual") || type.ends_with("Setting") || has("Camera") ||
           has("Light") || has("VisualManagerLoop") || type == "RequiredPlugin";
}

/// Throws an Error if a component that a step needs is missing.
void checkMessages(const std::vector<std::string>& messages, const std::string& file)
{
    for (const std::string& each : messages) {
        const std::string type = missingType(each);
        if (type.empty()) continue;
        if (!isForItsWindow(type)) fail(file, ": SOFA cannot make the component '", type, "': ", each);
        logInfo(file, ": left out '", type, "', which only SOFA's own window needs");
    }
}

std::vector<std::string> split(const std::string& list)
{
    std::vector<std::string> parts;
    std::istringstream in(list);
    for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
    return parts;
}

std::string linkedFolder()
{
    Dl_info info{};
    if (!dladdr(reinterpret_cast<const void*>(&::sofa::simulation::node::initRoot), &info) || !info.dli_fname)
        return {};
    return std::filesystem::path(info.dli_fname).parent_path().string();
}

/// As SOFA's own program does, once per process: what this one links needs no RequiredPlugin.
void loadLinkedParts()
{
    static const bool once = [] {
        for (const std::string& part : split(FILASOFIA_SOFA_PARTS)) {
            if (!part.starts_with("Sofa.Component.")) continue;
            ::sofa::helper::system::PluginManager::getInstance().loadPlugin(part);
            ::sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin(part);
        }
        return true;
    }();
    static_cast<void>(once);
}

/// Folders that SOFA searches while this exists: it keeps them once per process, for whatever scene comes next.
class SearchedFolders {
public:
    explicit SearchedFolders(const LoadDef& def)
    {
        add(system::PluginRepository, def.plugins.empty() ? linkedFolder() : def.plugins);
        for (auto folder = def.folders.rbegin(); folder != def.folders.rend(); ++folder)
            add(system::DataRepository, *folder);
    }
    ~SearchedFolders()
    {
        for (const auto& [repository, folder] : added_) {
            const auto& paths = repository->getPaths();
            if (std::ranges::find(paths, folder) != paths.end())
                repository->removePath(folder); // the first of its name
        }
    }
    SearchedFolders(const SearchedFolders&) = delete;
    SearchedFolders& operator=(const SearchedFolders&) = delete;

private:
    void add(system::FileRepository& repository, const std::string& folder)
    {
        const std::size_t before = repository.getPaths().size();
        repository.addFirstPath(folder);
        const std::size_t count = repository.getPaths().size() - before; // several, if ':' parts them
        for (std::size_t i = 0; i < count; ++i) added_.emplace_back(&repository, repository.getPaths()[i]);
    }
    std::vector<std::pair<system::FileRepository*, std::string>> added_;
};

std::string nameOf(const ::sofa::core::objectmodel::BaseObject& object)
{
    const std::string path = object.getPathName();
    return path.substr(path.find_first_not_of('/'));
}

/// Its numbers at rest, or zeros if it has none.
std::vector<double> atRest(const BaseMechanicalState& state)
{
    using ::sofa::core::vec_id::read_access::restPosition;
    const ::sofa::Size coords = state.getSize() * state.getCoordDimension();
    std::vector<double> numbers(coords + state.getSize() * state.getDerivDimension());
    const auto* places = dynamic_cast<const ::sofa::core::State<Vec3Types>*>(&state);
    const auto* rest = places ? places->read(restPosition) : nullptr;
    if (rest && rest->getValue().size() == state.getSize()) state.copyToBuffer(numbers.data(), restPosition, coords);
    return numbers;
}

bool isNear(double number, double unit) { return unit * std::abs(number) < physics::kFarthest; } // false for NaN too

/// Siblings in a scene may have the same name.
std::string uniqueName(const std::string& name, const std::set<std::string>& taken)
{
    std::string unique = name;
    for (int i = 2; taken.contains(unique); ++i) unique = text(name, "#", i);
    return unique;
}

} // namespace

Node::SPtr loadGraph(const LoadDef& def)
{
    if (!std::filesystem::exists(def.file)) fail(def.file, ": no such file");
    for (const std::string& folder : def.folders)
        if (!std::filesystem::is_directory(folder)) fail(def.file, ": folders: no such folder: ", folder);
    registerShownModel();
    const SearchedFolders searched(def);
    loadLinkedParts();
    const CollectErrors errors;
    Node::SPtr root;
    try {
        root = ::sofa::simulation::node::load(def.file);
        if (root) ::sofa::simulation::node::initRoot(root.get());
    } catch (...) {
        const std::string problem = problemNow();
        if (root) ::sofa::simulation::node::unload(root);
        fail(def.file, ": SOFA cannot load it: ", problem);
    }
    try {
        checkMessages(errors.messages(), def.file);
        if (!root)
            fail(def.file, ": SOFA cannot load it: ", errors.messages().empty() ? "" : errors.messages().front());
    } catch (const Error&) {
        if (root) ::sofa::simulation::node::unload(root);
        throw;
    }
    root->execute<::sofa::simulation::UpdateMappingVisitor>(::sofa::core::execparams::defaultInstance());
    return root;
}

std::vector<LoadedItem> itemsOf(Node& root, double unit, std::vector<std::string>& left)
{
    std::vector<::sofa::core::BaseState*> states;
    root.getTreeObjects<::sofa::core::BaseState>(&states);
    std::vector<LoadedItem> items;
    std::set<std::string> taken;
    for (::sofa::core::BaseState* each : states) {
        LoadedItem item{.name = uniqueName(nameOf(*each), taken)};
        taken.insert(item.name);
        if (makeItem(*each, unit, item))
            items.push_back(std::move(item));
        else
            left.push_back(item.name);
    }
    return items;
}

GraphState stateOfGraph(Node& root)
{
    std::vector<BaseMechanicalState*> states;
    root.getTreeObjects<BaseMechanicalState>(&states);
    GraphState out;
    for (const BaseMechanicalState* each : states) {
        const ::sofa::Size coords = each->getSize() * each->getCoordDimension();
        const ::sofa::Size derivs = each->getSize() * each->getDerivDimension();
        std::vector<double>& numbers = out.emplace_back(coords + derivs);
        each->copyToBuffer(numbers.data(), ::sofa::core::vec_id::read_access::position, coords);
        each->copyToBuffer(numbers.data() + coords, ::sofa::core::vec_id::read_access::velocity, derivs);
    }
    return out;
}

void setGraphState(const GraphState& state, Node& root, double unit)
{
    std::vector<BaseMechanicalState*> states;
    root.getTreeObjects<BaseMechanicalState>(&states);
    GraphState now = stateOfGraph(root);
    for (std::size_t i = 0; i < states.size(); ++i) {
        // What SOFA has cut meanwhile cannot be put back: it stays where it is, or else returns to its rest.
        const bool same = i < state.size() && state[i].size() == now[i].size();
        if (!same && !isUsable({now[i]}, unit)) now[i] = atRest(*states[i]);
        const std::vector<double>& numbers = same ? state[i] : now[i];
        const ::sofa::Size coords = states[i]->getSize() * states[i]->getCoordDimension();
        states[i]->copyFromBuffer(::sofa::core::vec_id::write_access::position, numbers.data(), coords);
        states[i]->copyFromBuffer(::sofa::core::vec_id::write_access::velocity, numbers.data() + coords,
                                  static_cast<unsigned>(numbers.size()) - coords);
    }
}

bool isUsable(const GraphState& state, double unit)
{
    const auto near = [&](double number) { return isNear(number, unit); };
    return std::ranges::all_of(state, [&](const auto& numbers) { return std::ranges::all_of(numbers, near); });
}

} // namespace filasofia::sofaengine
