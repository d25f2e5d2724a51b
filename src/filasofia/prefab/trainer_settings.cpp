#include "filasofia/prefab/trainer_settings.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>

namespace filasofia::prefab {
namespace {

std::string valueOf(const TrainerSetting& setting, double value)
{
    return setting.kind == TrainerSetting::Kind::Flag ? (value != 0.0 ? "true" : "false") : text(value);
}

/// "must be in [10, 3600] s; the time limit".
std::string commentOf(const TrainerSetting& setting)
{
    if (setting.kind == TrainerSetting::Kind::Flag) return setting.meaning;
    return text(setting.range.text(setting.unit), "; ", setting.meaning);
}

} // namespace

std::vector<TrainerSetting> settingsIn(const TrainerDef& def, int caseIndex)
{
    std::vector<TrainerSetting> out;
    const std::string& name = def.cases[static_cast<std::size_t>(caseIndex)];
    std::ranges::copy_if(def.settings, std::back_inserter(out), [&](const TrainerSetting& each) {
        return each.cases.empty() || std::ranges::find(each.cases, name) != each.cases.end();
    });
    return out;
}

std::string caseText(const TrainerDef& def, const TrainerCase& from, int difficulty)
{
    std::string lines;
    const std::vector<TrainerSetting> settings = settingsIn(def, from.base);
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const TrainerSetting& each = settings[i];
        const auto changed = from.settings.find(each.name);
        const double value =
            changed != from.settings.end() ? changed->second : each.usual[static_cast<std::size_t>(difficulty)];
        lines += text("        \"", each.name, "\": ", valueOf(each, value), i + 1 < settings.size() ? "," : "",
                      "  // ", commentOf(each), "\n");
    }
    return text("{\n    \"trainer\": \"", def.name, "\",\n    \"case\": \"",
                def.cases[static_cast<std::size_t>(from.base)], "\",\n",
                from.seed ? text("    \"seed\": ", *from.seed, ",\n") : "    // \"seed\": 7,  // always this patient\n",
                "    // \"picture\": \"mine.png\",  // for the start screen: a file beside this one\n",
                "    // A setting that is not here is that of the difficulty: delete what shall stay so.\n",
                "    \"settings\": {\n", lines, "    }\n}\n");
}

} // namespace filasofia::prefab
