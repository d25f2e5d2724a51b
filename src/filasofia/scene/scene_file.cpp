#include "filasofia/scene/scene_file.h"

#include "filasofia/scene/scene_reader.h"

namespace filasofia::scene {
namespace {

constexpr std::size_t kMaxFiles = 64; // a scene and those that it includes

/// Reads a scene with the files that it includes.
class SceneLoader {
public:
    SceneLoader(const std::filesystem::path& file, const SceneFileOptions& options)
        : reader_(sources_, folderOf(file), options)
    {
        include(file, file.string());
    }

    SceneDef load()
    {
        const std::vector<std::string> ownNames = {"$schema", "include", "defaults", "classes"};
        std::vector<std::string> known = fieldNames<SceneDef>();
        known.insert(known.end(), ownNames.begin(), ownNames.end());
        for (auto file = files_.rbegin(); file != files_.rend(); ++file) { // the including file comes first
            const Json& root = (*file)->root;
            reader_.refuseUnknown(root, Place{nullptr, "the scene"}, known);
            if (const auto found = root.find("defaults"); found != root.end()) addDefaults(*found);
            if (const auto found = root.find("classes"); found != root.end()) addClasses(*found);
        }
        std::vector<std::string> names;
        for (const char* list : {"bodies", "instruments"})
            forEachMember(list, [&](const Json& json, const Place&) {
                if (!json.is_object()) return;
                if (const auto name = json.find("name"); name != json.end() && name->is_string())
                    names.push_back(name->get<std::string>());
            });
        reader_.knowBodies(std::move(names));
        SceneDef scene;
        readList("bodies", scene.bodies, scene.places); // what has a number comes before what may name it
        readList("instruments", scene.instruments, scene.places);
        reader_.endBodies();
        forEachField<SceneDef>([&](const auto& each) {
            auto& member = scene.*(each.member);
            using Member = std::remove_cvref_t<decltype(member)>;
            if constexpr (std::is_same_v<Member, std::vector<SceneBody>> ||
                          std::is_same_v<Member, std::vector<SceneInstrument>>)
                return; // read already
            else if constexpr (kIsVector<Member>)
                readList(each.name, member, scene.places);
            else
                readMembers(each.name, {each.range, each.unit}, member, scene.places);
        });
        checkDefaults();
        scene.files = {files_.back()->path}; // itself comes last
        scene.files.insert(scene.files.end(), reader_.named().begin(), reader_.named().end());
        return scene;
    }

private:
    static std::filesystem::path folderOf(const std::filesystem::path& file)
    {
        return file.has_parent_path() ? file.parent_path() : ".";
    }

    /// Reads a file and, before it, those that it includes; each once.
    void include(const std::filesystem::path& path, const std::string& shown)
    {
        const SourceFile& file = sources_.read(path, shown);
        const Place place{nullptr, "include"};
        if (++read_ > kMaxFiles) fail(shown, ": a scene may have at most ", kMaxFiles, " files");
        if (!file.root.is_object()) reader_.refuse(file.root, Place{nullptr, "the scene"}, "must be an object");
        if (const auto list = file.root.find("include"); list != file.root.end()) {
            if (!list->is_array()) reader_.refuse(*list, place, "must be a list of files");
            for (std::size_t i = 0; i < list->size(); ++i) {
                const std::filesystem::path inner = reader_.fileNamed((*list)[i], Place{&place, {}, i});
                std::error_code problem;
                const auto same = [&](const auto& each) { return std::filesystem::equivalent(each, inner, problem); };
                if (std::ranges::any_of(open_, same) || same(path))
                    reader_.refuse((*list)[i], Place{&place, {}, i}, "must not be a file that includes this one");
                if (std::ranges::any_of(files_, [&](const SourceFile* each) { return same(each->path); })) continue;
                open_.push_back(path);
                include(inner, inner.string());
                open_.pop_back();
            }
        }
        files_.push_back(&file);
    }

    /// Checks the types that "defaults", or a class, names.
    void checkTypes(const Json& of, const Place& place)
    {
        if (!of.is_object()) reader_.refuse(of, place, "must be an object of objects, named by the types of Defs");
        reader_.refuseUnknown(of, place, types_);
        for (const auto& item : of.items()) {
            const Place at{&place, item.key()};
            if (!item.value().is_object()) reader_.refuse(item.value(), at, "must be an object");
            const auto named = item.value().find("type");
            if (named != item.value().end() && *named != item.key())
                reader_.refuse(*named, Place{&at, "type"}, text("must be ", item.key(), ", if it is given"));
            if (const auto found = item.value().find("class"); found != item.value().end())
                reader_.refuse(*found, Place{&at, "class"},
                               "must not be given: only objects of the scene have a class");
        }
    }
    void addDefaults(const Json& defaults)
    {
        checkTypes(defaults, Place{nullptr, "defaults"});
        reader_.addDefaults(defaults);
        toCheck_.emplace_back(&defaults, "defaults");
    }
    void addClasses(const Json& classes)
    {
        const Place place{nullptr, "classes"};
        if (!classes.is_object()) reader_.refuse(classes, place, "must be an object of classes, by their names");
        for (const auto& item : classes.items()) {
            checkTypes(item.value(), Place{&place, item.key()});
            toCheck_.emplace_back(&item.value(), text("classes.", item.key()));
        }
        reader_.addClasses(classes);
    }
    /// Reads the defaults for themselves, so that a mistake in one that nothing uses is found too.
    void checkDefaults()
    {
        for (const auto& each : toCheck_) {
            const Json& of = *each.first;
            const Place place{nullptr, each.second};
            std::set<std::string> seen;
            auto check = [&]<class T>() {
                const auto found = of.find(typeName<T>());
                if (found == of.end()) return;
                reader_.checkDefault<T>(*found, Place{&place, typeName<T>()});
            };
            DefWalk<SceneDef>::run(seen, check);
        }
    }

    /// The types of all Defs of a scene.
    static std::vector<std::string> defTypes()
    {
        std::vector<std::string> types;
        std::set<std::string> seen;
        auto add = [&]<class T>() { types.emplace_back(typeName<T>()); };
        DefWalk<SceneDef>::run(seen, add);
        return types;
    }

    template <class T> void readMembers(std::string_view name, const Bound& bound, T& out, Places& places)
    {
        Layers layers;
        for (auto file = files_.rbegin(); file != files_.rend(); ++file)
            if (const auto found = (*file)->root.find(name); found != (*file)->root.end()) layers.push_back({&*found});
        const Place place{nullptr, name};
        if constexpr (!std::is_arithmetic_v<T>)
            for (const Layer& each : layers)
                if (!each.json->is_object()) reader_.refuse(*each.json, place, "must be an object");
        if (layers.empty())
            reader_.fill(place, out);
        else
            reader_.readMember(layers, place, places, out, bound); // a number is that of the last file
    }
    /// The members of all files together.
    template <class T> void readList(std::string_view name, std::vector<T>& out, Places& places)
    {
        forEachMember(name, [&](const Json& json, const Place& place) {
            const Place numbered{place.outer, {}, out.size()}; // by its number in the scene, which files may share
            if constexpr (std::is_same_v<T, SceneBody>)
                out.push_back(reader_.readBody(json, place));
            else if constexpr (std::is_same_v<T, TimedCommand>)
                out.push_back(reader_.readCommand(json, place));
            else
                reader_.readMember({{&json}}, numbered, places, out.emplace_back());
            if constexpr (std::is_same_v<T, SceneInstrument>) reader_.addInstrument(out.back(), json, numbered);
        });
    }
    template <class Each> void forEachMember(std::string_view name, Each&& each)
    {
        const Place place{nullptr, name};
        for (const SourceFile* file : files_) {
            const auto list = file->root.find(name);
            if (list == file->root.end()) continue;
            if (!list->is_array()) reader_.refuse(*list, place, "must be a list");
            for (std::size_t i = 0; i < list->size(); ++i) each((*list)[i], Place{&place, {}, i});
        }
    }

    JsonSources sources_;
    SceneReader reader_;
    const std::vector<std::string> types_ = defTypes();
    std::vector<const SourceFile*> files_;    ///< those that are included before those that include them
    std::vector<std::filesystem::path> open_; ///< the files that include the one that is read
    std::size_t read_ = 0;
    std::vector<std::pair<const Json*, std::string>> toCheck_;
};

} // namespace

SceneDef loadScene(const std::filesystem::path& file, const SceneFileOptions& options)
{
    return SceneLoader(file, options).load();
}

} // namespace filasofia::scene
