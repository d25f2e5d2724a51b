#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/metric/session.h"

#include <span>

namespace filasofia::metric {

/// The evidence in the literature that a metric distinguishes novices from experts.
enum class Evidence {
    Discriminates, ///< at least one study found that it does
    DoesNot,       ///< it was studied, and does not
    Unknown,       ///< no study known to us
    Safety         ///< counted because it indicates harm, not because it measures skill
};
std::string_view name(Evidence evidence); ///< "discriminates"

enum class Group { Economy, Smoothness, Force, Safety, View, Task };
std::string_view name(Group group); ///< "Economy of motion"

enum class Better { Lower, Higher, Neither };

/// The description of a metric, needed to interpret its number. All units are SI.
struct MetricInfo {
    std::string_view id;   ///< "path_length": its name in files, which never changes
    std::string_view name; ///< "Path length"
    Group group = Group::Economy;
    std::string_view unit; ///< "m"; "-" for a number without unit
    Better better = Better::Neither;
    std::string_view definition; ///< one sentence
    std::string_view source;     ///< who defined it
    Evidence evidence = Evidence::Unknown;
    std::string_view found; ///< what was found, and by whom
};

/// All metrics, in the order of the report.
std::span<const MetricInfo> catalog();

/// One metric of one session: a finite number, or the reason why it is missing.
struct Value {
    std::optional<double> value = {};
    std::string reason = {};           ///< why the number is missing; empty if it is present
    std::optional<double> moment = {}; ///< [s], time in the session, if the metric has one
};

/// The parameters of the measures.
struct MeasureDef {
    double lowPass =
        20.0; ///< [Hz], in [0, 1000], cut-off of the filter of positions before any derivative; 0: no filter
    double maximumGap = 0.1; ///< [s], > 0: a longer time between two samples counts as a gap, in which nothing is known
    double fastest =
        5.0; ///< [m/s], > 0: a larger speed between two samples counts as a jump (such as a reset), not as motion
    double idleSpeed = 5e-3;    ///< [m/s], > 0: a lower speed counts as rest
    double peakShare = 0.1;     ///< [-], in (0, 1), share of the largest speed by which a speed peak must stand out
    double contactPause = 0.05; ///< [s], >= 0: a shorter pause does not end a contact
    double rupturePause = 0.5;  ///< [s], >= 0: a shorter pause does not end a cut or tear
    double forceWindow = 5e-3;  ///< [s], >= 0: force peaks, and times above a limit, use means over this time
    double lensReach = 5e-3;    ///< [m], > 0: a contact nearer to the lens than this counts as lens contact
};
constexpr auto fields(const MeasureDef*)
{
    using T = MeasureDef;
    return describe(
        "MeasureDef",
        field("lowPass", &T::lowPass, "Hz", closed(0, 1000), "cut-off frequency of the filter of positions"),
        field("maximumGap", &T::maximumGap, "s", positive(), "a longer time between two samples is a gap"),
        field("fastest", &T::fastest, "m/s", positive(), "a larger speed between two samples is a jump"),
        field("idleSpeed", &T::idleSpeed, "m/s", positive(), "a lower speed is rest"),
        field("peakShare", &T::peakShare, "-", open(0, 1),
              "share of the largest speed by which a speed peak stands out"),
        field("contactPause", &T::contactPause, "s", nonNegative(), "a shorter pause does not end a contact"),
        field("rupturePause", &T::rupturePause, "s", nonNegative(), "a shorter pause does not end a cut or tear"),
        field("forceWindow", &T::forceWindow, "s", nonNegative(), "averaging time of force peaks"),
        field("lensReach", &T::lensReach, "m", positive(), "a contact this near to the lens is a lens contact"));
}

/// Every metric of the catalog, in its order. Throws an Error if the Def is invalid; it never throws because of the
/// samples.
std::vector<Value> measure(const Session& session, const MeasureDef& def = {});

/// All metrics as the Markdown list of the docs' page on metrics.
std::string catalogMarkdown();

/// A number compared with those of other sessions.
struct Comparison {
    int others = 0;               ///< [-] number of other sessions that have the number
    double mean = 0.0;            ///< mean of the others
    double deviation = 0.0;       ///< standard deviation of the others (of a sample, n - 1)
    std::optional<double> z = {}; ///< (value - mean) / deviation
    std::string reason = {};      ///< why z is missing
};
/// With fewer others than this, their deviation is not meaningful.
inline constexpr int kMinOthers = 3;
Comparison compare(const Value& value, std::span<const double> others);

} // namespace filasofia::metric
