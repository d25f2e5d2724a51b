#include "filasofia/scene/case_file.h"

#include "filasofia/prefab/trainer_settings.h"
#include "filasofia/scene/scene_reader.h"

namespace filasofia::scene {
namespace {

using prefab::TrainerCase;
using prefab::TrainerDef;
using prefab::TrainerSetting;

class CaseReader {
public:
    CaseReader(const std::filesystem::path& file, const TrainerDef& def)
        : def_(def), source_(sources_.read(file, file.string())), reader_(sources_, absolute(file).parent_path(), {})
    {
    }

    TrainerCase read()
    {
        const Json& root = source_.root;
        if (!root.is_object()) reader_.refuse(root, top("a case"), "must be an object");
        reader_.refuseUnknown(root, top("a case"), {"trainer", "case", "seed", "picture", "settings"});
        TrainerCase out{.name = source_.path.stem().string(), .file = source_.path};
        checkTrainer(required("trainer"));
        out.base = ownCase(required("case"));
        if (root.contains("seed")) {
            constexpr Bound kSeeds = {closed(0, 999'999'999), {}};
            reader_.read({{&root.at("seed")}}, top("seed"), kSeeds, out.seed.emplace());
        }
        if (root.contains("picture")) out.picture = reader_.fileNamed(root.at("picture"), top("picture"));
        if (root.contains("settings")) readSettings(root.at("settings"), out);
        return out;
    }

private:
    static Place top(std::string_view name) { return {nullptr, name}; }

    const Json& required(const char* name)
    {
        const Json& root = source_.root;
        if (!root.contains(name)) reader_.refuse(root, top("a case"), text("must have the field '", name, "'"));
        return root.at(name);
    }
    void checkTrainer(const Json& json)
    {
        if (reader_.word(json, top("trainer")) != def_.name)
            reader_.refuse(json, top("trainer"), text("must be '", def_.name, "', whose case this is to be"));
    }
    int ownCase(const Json& json)
    {
        const std::string name = reader_.word(json, top("case"));
        const auto found = std::ranges::find(def_.cases, name);
        if (found == def_.cases.end())
            reader_.refuse(json, top("case"), "must be one of the trainer's own", didYouMeanOneOf(name, def_.cases));
        return static_cast<int>(found - def_.cases.begin());
    }
    void readSettings(const Json& json, TrainerCase& out)
    {
        const Place place = top("settings");
        if (!json.is_object()) reader_.refuse(json, place, "must be an object");
        const std::vector<TrainerSetting> settings = prefab::settingsIn(def_, out.base);
        std::vector<std::string> known;
        for (const TrainerSetting& each : settings) known.push_back(each.name);
        reader_.refuseUnknown(json, place, known);
        for (const TrainerSetting& each : settings)
            if (json.contains(each.name)) out.settings[each.name] = valueOf(each, json.at(each.name), place);
    }
    double valueOf(const TrainerSetting& setting, const Json& json, const Place& outer)
    {
        const Place place{&outer, setting.name};
        const Bound bound{setting.range, setting.unit};
        const auto as = [&](auto value) {
            reader_.read({{&json}}, place, bound, value);
            return static_cast<double>(value);
        };
        switch (setting.kind) {
        case TrainerSetting::Kind::Number:
            return as(0.0);
        case TrainerSetting::Kind::Whole:
            return as(0);
        case TrainerSetting::Kind::Flag:
            return as(false);
        }
        return 0.0;
    }

    const TrainerDef& def_;
    JsonSources sources_;
    const SourceFile& source_;
    SceneReader reader_;
};

} // namespace

TrainerCase loadCase(const std::filesystem::path& file, const TrainerDef& def) { return CaseReader(file, def).read(); }

} // namespace filasofia::scene
