#include "filasofia/metric/catalog.h"

#include "filasofia/core/validate.h"
#include "filasofia/metric/measure.h"

#include <cmath>

namespace filasofia::metric {
namespace {

using enum Evidence;
using enum Better;

// Sources that several metrics have. What they found is told as the papers and reviews report it, no more.
constexpr std::string_view kOurs = "this project";
constexpr std::string_view kOropesa = "Oropesa et al., Surgical Innovation 20, 2013";
constexpr std::string_view kPanel = "Panel et al., J Gynecol Obstet Hum Reprod 47, 2018";
constexpr std::string_view kAghazadeh = "Aghazadeh et al., Sensors 23:3146, 2023";
constexpr std::string_view kGolahmadi = "Golahmadi et al., Annals of Medicine and Surgery 65, 2021";
constexpr std::string_view kForceFound =
    "a review of 45 studies: novices exerted 22.7 % more mean force than experts, and "
    "feedback lowered it by 47.9 % (Golahmadi 2021)";
constexpr std::string_view kForceKin = "of a kind with the mean force (Golahmadi 2021); by itself no study known to us";
constexpr std::string_view kNotKnown = "no study known to us";
constexpr std::string_view kSafety =
    "counted because it harms; in one study the experienced even scored worse in safety than novices (Bajka 2010)";

struct Entry {
    MetricInfo info;
    Value (*measure)(const Material&);
};

constexpr Entry kEntries[] = {
    {{"duration", "Time", Group::Economy, "s", Lower, "From the tool's first sample to its last.", kOropesa,
      Discriminates,
      "told skill levels apart in all three tasks (Oropesa 2013); in hysteroscopy as part of the economy score (Panel "
      "2018)"},
     duration},
    {{"path_length", "Path length", Group::Economy, "m", Lower,
      "Sum of the displacements of the tool's tip; in gaps nothing is added.", kOropesa, Discriminates,
      "told skill levels apart in all three tasks (Oropesa 2013); in hysteroscopy as part of the economy score (Panel "
      "2018)"},
     pathLength},
    {{"depth_path", "Depth path", Group::Economy, "m", Lower,
      "Sum of the tip's displacements along the instrument's own axis.", kOropesa, Discriminates,
      "told skill levels apart in all three tasks (Oropesa 2013)"},
     depthPath},
    {{"economy", "Economy of motion", Group::Economy, "-", Higher,
      "The case's ideal path over the path length: 1 is perfect.", kPanel, Discriminates,
      "for one case it is the path length turned over; an economy score of path, time and camera alignment told "
      "novices from experts in four of four resections (Panel 2018)"},
     economy},
    {{"speed_mean", "Mean speed", Group::Economy, "m/s", Neither, "Path length over the time observed without gaps.",
      kOropesa, Unknown,
      "depends little on the task (Oropesa 2013); fast is not skilled: read it beside path and forces"},
     meanSpeed},
    {{"speed_peak", "Peak speed", Group::Economy, "m/s", Neither, "The largest speed of the tip.", kOurs, Unknown,
      kNotKnown},
     peakSpeed},
    {{"idle_share", "Idle time", Group::Economy, "-", Lower,
      "Share of the time in which the tip is slower than 5 mm/s (our threshold).", kOropesa, Discriminates,
      "told skill levels apart in the tasks that ask for planning (Oropesa 2013)"},
     idleShare},
    {{"idle_longest", "Longest rest", Group::Economy, "s", Neither, "The longest time slower than 5 mm/s.", kOurs,
      Unknown, kNotKnown},
     longestRest},
    {{"working_volume", "Working volume", Group::Economy, "m^3", Lower, "Volume of the convex hull of the tip's path.",
      kOurs, Unknown, kNotKnown},
     workingVolume},
    {{"bimanual_correlation", "Bimanual correlation", Group::Economy, "-", Neither,
      "Correlation (Pearson) of the speeds of the two tools' tips at the same moments.", kOurs, Unknown, kNotKnown},
     bimanualCorrelation},

    {{"sparc", "Spectral arc length (SPARC)", Group::Smoothness, "-", Higher,
      "Minus the length of the speed's amplitude spectrum, normalised, up to where it stays below 5 %, at most 10 Hz; "
      "one smooth reach has about -1.4.",
      "Balasubramanian et al., IEEE TBME 59, 2012, and J NeuroEng Rehabil 12:112, 2015", Unknown,
      "the measure of smoothness least disturbed by noise and duration (Balasubramanian 2015); made for single "
      "movements: of whole sessions compare only those of one case"},
     sparc},
    {{"log_dimensionless_jerk", "Log dimensionless jerk", Group::Smoothness, "-", Higher,
      "Minus the logarithm of: the integral of the squared jerk, times duration cubed, over peak speed squared; a "
      "minimum-jerk reach has -5.32.",
      "Hogan and Sternad, J Mot Behav 41, 2009; Balasubramanian 2015", Discriminates,
      "told skill levels apart where the mean jerk did not (Aghazadeh 2023)"},
     logDimensionlessJerk},
    {{"motion_frequency", "95 % motion frequency", Group::Smoothness, "Hz", Lower,
      "The frequency below which 95 % of the power of the tip's velocity lies; as fine as one over the duration.",
      kAghazadeh, Discriminates, "told skill levels apart (Aghazadeh 2023)"},
     motionFrequency},
    {{"speed_peaks", "Speed peaks", Group::Smoothness, "-", Lower,
      "How often the speed rises and falls again by a tenth of the peak speed.",
      "Balasubramanian 2015, who advises against it", Unknown,
      "crude: depends on the threshold; grows with the length of the task"},
     speedPeaks},

    {{"force_max", "Largest force", Group::Force, "N", Lower,
      "The largest mean over 5 ms of the force on any instrument, the scope too: of all that touches it and that it "
      "holds.",
      kGolahmadi, Unknown, kForceKin},
     maxForce},
    {{"force_mean", "Mean force", Group::Force, "N", Lower, "The mean force on the tool over the time in contact.",
      kGolahmadi, Discriminates, kForceFound},
     meanForce},
    {{"force_rms", "RMS force", Group::Force, "N", Lower,
      "The root of the mean squared force on the tool over the time in contact.", kOurs, Unknown, kForceKin},
     rmsForce},
    {{"force_impulse", "Force over time", Group::Force, "N s", Lower,
      "The integral of the force on the tool over time.", kOurs, Unknown, kForceKin},
     forceImpulse},
    {{"force_over_time", "Time above the limit", Group::Force, "s", Lower,
      "Time in which the force on any instrument, as a mean over 5 ms, is above what the case says that the tissue "
      "stands.",
      kOurs, Safety, kSafety},
     timeAboveLimit},
    {{"force_over_count", "Times above the limit", Group::Force, "-", Lower,
      "How often the force rises above that limit.", kOurs, Safety, kSafety},
     timesAboveLimit},
    {{"contact_count", "Contacts", Group::Force, "-", Lower,
      "How often the tool begins to touch or hold anything; pauses below 0.05 s are none.", kOurs, Unknown, kNotKnown},
     contactCount},
    {{"contact_time", "Time in contact", Group::Force, "s", Neither,
      "Time in which the tool touches or holds anything.", kOurs, Unknown, kNotKnown},
     contactTime},
    {{"contact_longest", "Longest contact", Group::Force, "s", Neither, "The longest contact.", kOurs, Unknown,
      kNotKnown},
     longestContact},
    {{"contact_peak_mean", "Mean peak of a contact", Group::Force, "N", Lower,
      "The largest mean over 5 ms of each contact, averaged over the contacts.", kOurs, Unknown, kForceKin},
     meanContactPeak},

    {{"perforations", "Perforations", Group::Safety, "-", Lower,
      "How often the simulator told that a wall was pierced.", kOurs, Safety, kSafety},
     perforations},
    {{"tears_unintended", "Unintended tears", Group::Safety, "-", Lower,
      "How often stress opened a body that the case does not name as a target; what tears on within 0.5 s is one.",
      kOurs, Safety, kSafety},
     unintendedTears},
    {{"cuts_unintended", "Unintended cuts", Group::Safety, "-", Lower,
      "How often a blade opened a body that the case does not name as a target; what is cut on within 0.5 s is one.",
      kOurs, Safety, kSafety},
     unintendedCuts},
    {{"area_unintended", "Area opened unintended", Group::Safety, "m^2", Lower,
      "The area of all those tears and cuts, of one of the two sides.", kOurs, Safety, kSafety},
     unintendedArea},
    {{"volume_removed", "Volume removed", Group::Safety, "m^3", Neither,
      "The volume of what was taken out, as the simulator told.", kOurs, Unknown, kNotKnown},
     volumeRemoved},

    {{"horizon_error", "Horizon error", Group::View, "rad", Lower,
      "Mean angle between the upper side of the scope's picture and the vertical, about the line of sight.", kPanel,
      Unknown,
      "camera alignment is part of an economy score that told novices from experts (Panel 2018); by itself not known"},
     horizonError},
    {{"lens_contact", "Lens contact", Group::View, "s", Lower,
      "Time in which the scope's strongest contact lies within 5 mm of its lens.", kOurs, Unknown, kNotKnown},
     lensContactTime},
    {{"out_of_view", "Tool out of view", Group::View, "s", Lower,
      "Time in which the tool's tip lies outside the cone that the scope sees.", kOurs, Unknown, kNotKnown},
     outOfViewTime},
    {{"share_seen", "Surface seen", Group::View, "-", Higher,
      "Share of the surface to be inspected that has been seen at the end, as the simulator told.",
      "Bajka et al., Surgical Endoscopy 24, 2010", DoesNot,
      "the visualisation score did not tell novices from experts (Bajka 2010): a matter of completeness, not of skill"},
     shareSeen},

    {{"steps_done", "Steps done", Group::Task, "-", Higher, "Share of the steps of the task that were done.", kOurs,
      DoesNot,
      "a checklist of the task did not tell novices from the experienced (P = 0.09; Vassiliou et al., Am J Surg 190, "
      "2005)"},
     stepsDone},
    {{"mistakes", "Mistakes", Group::Task, "-", Lower, "How often the simulator told of what the task calls a mistake.",
      kOurs, Safety, "what a mistake is, the task says"},
     mistakes},
    {{"residual", "Target left", Group::Task, "-", Lower,
      "Share of the target that is left at the end, as the simulator told.", kOurs, Unknown, kNotKnown},
     residual},
};

} // namespace

std::string_view name(Evidence evidence)
{
    switch (evidence) {
    case Discriminates:
        return "discriminates";
    case DoesNot:
        return "does not discriminate";
    case Unknown:
        return "not known";
    case Safety:
        break;
    }
    return "safety item";
}

std::string_view name(Group group)
{
    switch (group) {
    case Group::Economy:
        return "Economy of motion";
    case Group::Smoothness:
        return "Smoothness";
    case Group::Force:
        return "Force and contact";
    case Group::Safety:
        return "Safety";
    case Group::View:
        return "View";
    case Group::Task:
        break;
    }
    return "Task";
}

std::span<const MetricInfo> catalog()
{
    static const std::vector<MetricInfo> infos = [] {
        std::vector<MetricInfo> all;
        for (const Entry& entry : kEntries) all.push_back(entry.info);
        return all;
    }();
    return infos;
}

std::vector<Value> measure(const Session& session, const MeasureDef& def)
{
    validate(def, "measure");
    const Material material = materialOf(session, def);
    std::vector<Value> values;
    for (const Entry& entry : kEntries) {
        Value value = entry.measure(material);
        // Places of 1e300 m are finite, and their squares are not.
        if (value.value && !std::isfinite(*value.value)) value = none("the samples are too large to compute with");
        values.push_back(std::move(value));
    }
    return values;
}

std::string catalogMarkdown()
{
    std::string out;
    std::optional<Group> group;
    for (const Entry& entry : kEntries) {
        const MetricInfo& info = entry.info;
        if (group != info.group)
            out += text(out.empty() ? "" : "\n", "## ", name(info.group), "\n\n",
                        "| Metric | Definition | Unit | Better | Source | Tells novices from experts? "
                        "|\n|---|---|---|---|---|---|\n");
        group = info.group;
        const char* better = info.better == Lower ? "lower" : info.better == Higher ? "higher" : "neither";
        out += text("| ", info.name, " `", info.id, "` | ", info.definition, " | ", info.unit, " | ", better, " | ",
                    info.source, " | **", name(info.evidence), "**: ", info.found, " |\n");
    }
    return out;
}

Comparison compare(const Value& value, std::span<const double> others)
{
    Comparison comparison{.others = static_cast<int>(others.size())};
    for (const double other : others) comparison.mean += other;
    if (!others.empty()) comparison.mean /= static_cast<double>(others.size());
    double squares = 0.0;
    for (const double other : others) squares += (other - comparison.mean) * (other - comparison.mean);
    if (others.size() > 1) comparison.deviation = std::sqrt(squares / static_cast<double>(others.size() - 1));
    if (!value.value) {
        comparison.reason = value.reason;
    } else if (comparison.others < kFewestOthers) {
        comparison.reason = text("needs ", kFewestOthers, " other sessions, has ", comparison.others);
    } else if (comparison.deviation <= 1e-12 * std::abs(comparison.mean)) {
        comparison.reason = "all others have the same number";
    } else {
        comparison.z = (*value.value - comparison.mean) / comparison.deviation;
    }
    return comparison;
}

} // namespace filasofia::metric
