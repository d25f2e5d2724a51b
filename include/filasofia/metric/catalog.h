#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/metric/session.h"

#include <span>

namespace filasofia::metric {

/// What the literature says of a metric: does it tell novices from experts?
enum class Evidence {
    Discriminates, ///< at least one study found that it does
    DoesNot,       ///< it was studied, and does not
    Unknown,       ///< no study known to us
    Safety         ///< counted because it harms, not because it tells anybody from anybody
};
std::string_view name(Evidence evidence); ///< "discriminates"

enum class Group { Economy, Smoothness, Force, Safety, View, Task };
std::string_view name(Group group); ///< "Economy of motion"

enum class Better { Lower, Higher, Neither };

/// What a person must know of a metric before believing its number. All units are SI.
struct MetricInfo {
    std::string_view id;   ///< "path_length": its name in files, for ever
    std::string_view name; ///< "Path length"
    Group group = Group::Economy;
    std::string_view unit; ///< "m"; "-" for a plain number
    Better better = Better::Neither;
    std::string_view definition; ///< in one sentence
    std::string_view source;     ///< who defined it
    Evidence evidence = Evidence::Unknown;
    std::string_view found; ///< what was found, and by whom
};

/// All metrics, in the order of the report.
std::span<const MetricInfo> catalog();

/// One metric of one session: a finite number, or the reason why there is none.
struct Value {
    std::optional<double> value = {};
    std::string reason = {};           ///< why there is no number; empty where there is one
    std::optional<double> moment = {}; ///< [s], when in the session, of what has a moment
};

/// How samples become numbers.
struct MeasureDef {
    double lowPass = 20.0;   ///< [Hz], in [0, 1000], of positions before anything is derived; 0: as they were sampled
    double maximumGap = 0.1; ///< [s], > 0: between samples further apart nothing is known
    double fastest = 5.0;    ///< [m/s], > 0: from sample to sample no hand is faster; it was put there (reset)
    double idleSpeed = 5e-3; ///< [m/s], > 0: slower is at rest
    double peakShare = 0.1;  ///< [-], in (0, 1), of the largest speed: a speed peak stands out by so much
    double contactPause = 0.05; ///< [s], >= 0: who touches again sooner has not let go
    double rupturePause = 0.5;  ///< [s], >= 0: what opens again sooner is the same cut or tear
    double forceWindow = 5e-3;  ///< [s], >= 0: peaks of the force and what is above a limit are of means over so long
    double lensReach = 5e-3;    ///< [m], > 0: a contact so near to the lens is one of the lens
};
constexpr auto fields(const MeasureDef*)
{
    using T = MeasureDef;
    return describe("MeasureDef", field("lowPass", &T::lowPass, "Hz", closed(0, 1000), "of positions"),
                    field("maximumGap", &T::maximumGap, "s", positive(), "more is a gap"),
                    field("fastest", &T::fastest, "m/s", positive(), "faster is a jump"),
                    field("idleSpeed", &T::idleSpeed, "m/s", positive(), "slower is at rest"),
                    field("peakShare", &T::peakShare, "-", open(0, 1), "by which a speed peak stands out"),
                    field("contactPause", &T::contactPause, "s", nonNegative(), "a shorter pause is none"),
                    field("rupturePause", &T::rupturePause, "s", nonNegative(), "a shorter pause is none"),
                    field("forceWindow", &T::forceWindow, "s", nonNegative(), "of the means that peaks are of"),
                    field("lensReach", &T::lensReach, "m", positive(), "a contact so near is one of the lens"));
}

/// Every metric of the catalog, in its order. Throws Error where the Def is wrong; whatever the samples are, it does
/// not.
std::vector<Value> measure(const Session& session, const MeasureDef& def = {});

/// The table of docs/guide/metrics.md.
std::string catalogMarkdown();

/// A number beside those of other sessions.
struct Comparison {
    int others = 0;               ///< [-] sessions that have the number
    double mean = 0.0;            ///< of the others
    double deviation = 0.0;       ///< of the others, the standard deviation of a sample (n - 1)
    std::optional<double> z = {}; ///< (value - mean) / deviation
    std::string reason = {};      ///< why there is no z
};
/// Fewer than this many others say nothing about how they spread.
inline constexpr int kFewestOthers = 3;
Comparison compare(const Value& value, std::span<const double> others);

} // namespace filasofia::metric
