#include "filasofia/metric/catalog.h"

#include "filasofia/core/validate.h"
#include "filasofia/metric/measure.h"

#include <algorithm>
#include <cmath>

namespace filasofia::metric {
namespace {

using enum Evidence;
using enum Better;

// Sources of several metrics. Findings are as the papers and reviews report them, no more.
constexpr std::string_view kOurs = "this project";
constexpr std::string_view kOropesa = "Oropesa et al., Surgical Innovation 20, 2013";
constexpr std::string_view kPanel = "Panel et al., J Gynecol Obstet Hum Reprod 47, 2018";
constexpr std::string_view kAghazadeh = "Aghazadeh et al., Sensors 23:3146, 2023";
constexpr std::string_view kGolahmadi = "Golahmadi et al., Annals of Medicine and Surgery 65, 2021";
constexpr std::string_view kForceFound =
    "A review of 45 studies: novices exerted 22.7 % more mean force than experts, and "
    "feedback lowered the mean force by 47.9 % (Golahmadi 2021).";
constexpr std::string_view kForceKin =
    "Related to the mean force (Golahmadi 2021); we know of no study of this metric itself.";
constexpr std::string_view kNotKnown = "We know of no study.";
constexpr std::string_view kSafety = "Counted because it indicates harm. In one study, experienced participants even "
                                     "scored worse in safety than novices (Bajka 2010).";

struct Entry {
    MetricInfo info;
    Value (*measure)(const Material&);
};

constexpr Entry kEntries[] = {
    {{"duration", "Time", Group::Economy, "s", Lower, "The time from the tool's first sample to its last.", kOropesa,
      Discriminates,
      "Distinguished skill levels in all three tasks (Oropesa 2013); in hysteroscopy, as part of the economy score "
      "(Panel "
      "2018)."},
     duration},
    {{"path_length", "Path length", Group::Economy, "m", Lower,
      "The sum of the displacements of the tool's tip; gaps add nothing.", kOropesa, Discriminates,
      "Distinguished skill levels in all three tasks (Oropesa 2013); in hysteroscopy, as part of the economy score "
      "(Panel "
      "2018)."},
     pathLength},
    {{"depth_path", "Depth path", Group::Economy, "m", Lower,
      "The sum of the tip's displacements along the instrument's own axis.", kOropesa, Discriminates,
      "Distinguished skill levels in all three tasks (Oropesa 2013)."},
     depthPath},
    {{"economy", "Economy of motion", Group::Economy, "-", Higher,
      "The length of the case's ideal path divided by the path length; 1 is perfect.", kPanel, Discriminates,
      "For a single case it is the inverse of the path length. An economy score of path, time and camera alignment "
      "distinguished "
      "novices from experts in four of four resections (Panel 2018)."},
     economy},
    {{"speed_mean", "Mean speed", Group::Economy, "m/s", Neither,
      "The path length divided by the time observed without gaps.", kOropesa, Unknown,
      "Depends little on the task (Oropesa 2013). A fast trainee is not necessarily a skilled one: compare with path "
      "and forces."},
     meanSpeed},
    {{"speed_peak", "Peak speed", Group::Economy, "m/s", Neither, "The largest speed of the tip.", kOurs, Unknown,
      kNotKnown},
     peakSpeed},
    {{"idle_share", "Idle time", Group::Economy, "-", Lower,
      "The share of the time in which the tip moves slower than 5 mm/s (our threshold).", kOropesa, Discriminates,
      "Distinguished skill levels in the tasks that require planning (Oropesa 2013)."},
     idleShare},
    {{"idle_longest", "Longest rest", Group::Economy, "s", Neither,
      "The longest uninterrupted time in which the tip moves slower than 5 mm/s.", kOurs, Unknown, kNotKnown},
     longestRest},
    {{"working_volume", "Working volume", Group::Economy, "m^3", Lower,
      "The volume of the convex hull of the tip's path.", kOurs, Unknown, kNotKnown},
     workingVolume},
    {{"bimanual_correlation", "Bimanual correlation", Group::Economy, "-", Neither,
      "The Pearson correlation of the speeds of the two tools' tips at the same moments.", kOurs, Unknown, kNotKnown},
     bimanualCorrelation},

    {{"sparc", "Spectral arc length (SPARC)", Group::Smoothness, "-", Higher,
      "Minus the arc length of the normalised amplitude spectrum of the speed, up to the frequency above which it "
      "stays below 5 %, at most 10 Hz; "
      "a single smooth reach has about -1.4.",
      "Balasubramanian et al., IEEE TBME 59, 2012, and J NeuroEng Rehabil 12:112, 2015", Unknown,
      "The measure of smoothness that noise and duration affect least (Balasubramanian 2015). It was defined for "
      "single "
      "movements: compare whole sessions only if they are of the same case."},
     sparc},
    {{"log_dimensionless_jerk", "Log dimensionless jerk", Group::Smoothness, "-", Higher,
      "Minus the logarithm of the integral of the squared jerk, times the duration cubed, divided by the peak speed "
      "squared; a "
      "minimum-jerk reach has -5.32.",
      "Hogan and Sternad, J Mot Behav 41, 2009; Balasubramanian 2015", Discriminates,
      "Distinguished skill levels although the mean jerk did not (Aghazadeh 2023)."},
     logDimensionlessJerk},
    {{"motion_frequency", "95 % motion frequency", Group::Smoothness, "Hz", Lower,
      "The frequency below which 95 % of the power of the tip's velocity lies; its resolution is one over the "
      "duration.",
      kAghazadeh, Discriminates, "Distinguished skill levels (Aghazadeh 2023)."},
     motionFrequency},
    {{"speed_peaks", "Speed peaks", Group::Smoothness, "-", Lower,
      "The number of times that the speed rises and falls again by a tenth of the peak speed.",
      "Balasubramanian 2015, who advise against it", Unknown,
      "A crude measure: it depends on the threshold and grows with the length of the task."},
     speedPeaks},

    {{"force_max", "Largest net force", Group::Force, "N", Lower,
      "The largest force, as a mean over 5 ms, of contacts and attachments on one instrument, which may be the scope. "
      "It is a net force: what presses on the instrument from opposite sides cancels. The total force, which a force "
      "bar shows, adds the magnitudes of all contacts of all instruments.",
      kGolahmadi, Unknown, kForceKin},
     maxForce},
    {{"force_mean", "Mean force", Group::Force, "N", Lower, "The mean force on the tool during the time in contact.",
      kGolahmadi, Discriminates, kForceFound},
     meanForce},
    {{"force_rms", "RMS force", Group::Force, "N", Lower,
      "The root mean square of the force on the tool during the time in contact.", kOurs, Unknown, kForceKin},
     rmsForce},
    {{"force_impulse", "Force over time", Group::Force, "N s", Lower,
      "The integral of the force on the tool over time.", kOurs, Unknown, kForceKin},
     forceImpulse},
    {{"force_over_time", "Time above the limit", Group::Force, "s", Lower,
      "The time in which the force on any instrument, as a mean over 5 ms, exceeds the force limit of the tissue that "
      "the case "
      "specifies.",
      kOurs, Safety, kSafety},
     timeAboveLimit},
    {{"force_over_count", "Times above the limit", Group::Force, "-", Lower,
      "The number of times that the force rises above that limit.", kOurs, Safety, kSafety},
     timesAboveLimit},
    {{"contact_count", "Contacts", Group::Force, "-", Lower,
      "The number of times that the tool begins to touch or hold anything; a pause shorter than 0.05 s does not end a "
      "contact.",
      kOurs, Unknown, kNotKnown},
     contactCount},
    {{"contact_time", "Time in contact", Group::Force, "s", Neither,
      "The time in which the tool touches or holds anything.", kOurs, Unknown, kNotKnown},
     contactTime},
    {{"contact_longest", "Longest contact", Group::Force, "s", Neither, "The duration of the longest contact.", kOurs,
      Unknown, kNotKnown},
     longestContact},
    {{"contact_peak_mean", "Mean peak of a contact", Group::Force, "N", Lower,
      "The largest force of each contact, as a mean over 5 ms, averaged over the contacts.", kOurs, Unknown, kForceKin},
     meanContactPeak},

    {{"perforations", "Perforations", Group::Safety, "-", Lower,
      "The number of times that the simulator reported a pierced wall.", kOurs, Safety, kSafety},
     perforations},
    {{"tears_unintended", "Unintended tears", Group::Safety, "-", Lower,
      "The number of times that stress opened a body that is not a target of the case; tears of one body less than 0.5 "
      "s apart count as one.",
      kOurs, Safety, kSafety},
     unintendedTears},
    {{"cuts_unintended", "Unintended cuts", Group::Safety, "-", Lower,
      "The number of times that a blade opened a body that is not a target of the case; cuts of one body less than 0.5 "
      "s apart count as one.",
      kOurs, Safety, kSafety},
     unintendedCuts},
    {{"area_unintended", "Unintended opened area", Group::Safety, "m^2", Lower,
      "The total area of the unintended tears and cuts, counting one of the two sides.", kOurs, Safety, kSafety},
     unintendedArea},
    {{"blood_lost", "Blood lost", Group::Safety, "m^3", Lower,
      "The volume of blood that welled from all bodies, as the simulator reports it once per second.", kOurs, Safety,
      kSafety},
     bloodLost},
    {{"duct_leak", "Lost from ducts", Group::Safety, "m^3", Lower,
      "The volume that flowed out of cut ducts, as the simulator reports it. Blood of a body that bleeds is also in "
      "the blood lost.",
      kOurs, Safety, kSafety},
     ductLeak},
    {{"fluid_deficit", "Fluid deficit", Group::Safety, "m^3", Lower,
      "The largest volume of fluid that had flowed into the distended cavity and not out of it, as the simulator "
      "reports "
      "it once per second.",
      kOurs, Safety, kSafety},
     fluidDeficit},
    {{"clips_placed", "Clips placed", Group::Safety, "-", Neither,
      "The number of clips that were closed on tissue, those among them that slipped off later.", kOurs, Unknown,
      kNotKnown},
     clipsPlaced},
    {{"clips_lost", "Clips lost", Group::Safety, "-", Lower, "The number of clips that were closed on nothing.", kOurs,
      Safety, kSafety},
     clipsLost},
    {{"clips_slipped", "Clips slipped", Group::Safety, "-", Lower,
      "The number of clips that were pulled off, or whose tissue was removed.", kOurs, Safety, kSafety},
     clipsSlipped},
    {{"burnt_unintended", "Unintended burn", Group::Safety, "m^2", Lower,
      "The largest burnt area of each body that is no target of heat, summed over these bodies.", kOurs, Safety,
      kSafety},
     unintendedBurn},
    {{"activation_time", "Activation", Group::Safety, "s", Neither,
      "The time in which electrodes were active, summed over them.", kOurs, Unknown, kNotKnown},
     activationTime},
    {{"activation_in_air", "Activation in air", Group::Safety, "s", Lower,
      "The part of the activation in which the electrode's tip touched no tissue that burns.", kOurs, Unknown,
      kNotKnown},
     activationInAir},
    {{"energy_delivered", "Energy delivered", Group::Safety, "J", Neither, "The heat that tissue took from electrodes.",
      kOurs, Unknown, kNotKnown},
     energyDelivered},
    {{"volume_removed", "Volume removed", Group::Safety, "m^3", Neither,
      "The volume of the removed pieces, as reported by the simulator.", kOurs, Unknown, kNotKnown},
     volumeRemoved},

    {{"horizon_error", "Horizon error", Group::View, "rad", Lower,
      "The mean angle, about the line of sight, between the upper side of the scope's picture and the vertical.",
      kPanel, Unknown,
      "Camera alignment is part of an economy score that distinguished novices from experts (Panel 2018); we know of "
      "no study of this metric itself."},
     horizonError},
    {{"lens_contact", "Lens contact", Group::View, "s", Lower,
      "The time in which the scope's strongest contact lies within 5 mm of its lens.", kOurs, Unknown, kNotKnown},
     lensContactTime},
    {{"out_of_view", "Tool out of view", Group::View, "s", Lower,
      "The time in which the tool's tip lies outside the scope's cone of view.", kOurs, Unknown, kNotKnown},
     outOfViewTime},
    {{"share_seen", "Surface seen", Group::View, "-", Higher,
      "The share of the surface to be inspected that has been seen at the end, as reported by the simulator.",
      "Bajka et al., Surgical Endoscopy 24, 2010", DoesNot,
      "The visualisation score did not distinguish novices from experts (Bajka 2010): it measures completeness, not "
      "skill."},
     shareSeen},

    {{"steps_done", "Steps done", Group::Task, "-", Higher, "The share of the task's steps that were done.", kOurs,
      DoesNot,
      "A checklist of the task did not distinguish novices from experienced participants (P = 0.09; Vassiliou et al., "
      "Am J "
      "Surg 190, "
      "2005)."},
     stepsDone},
    {{"mistakes", "Mistakes", Group::Task, "-", Lower, "The number of mistakes that the simulator reported.", kOurs,
      Safety, "The task defines what a mistake is."},
     mistakes},
    {{"residual", "Target left", Group::Task, "-", Lower,
      "The share of the target that is left at the end, as reported by the simulator.", kOurs, Unknown, kNotKnown},
     residual},
};

/// Appends an item of a list, broken into lines of at most 160 characters.
void appendWrapped(std::string& out, std::string_view words)
{
    constexpr std::size_t kColumns = 160;
    std::size_t column = 0;
    while (!words.empty()) {
        const std::string_view word = words.substr(0, words.find(' '));
        const bool fits = column + 1 + word.size() <= kColumns;
        if (column > 0) out += fits ? " " : "\n  ";
        column = (column == 0 ? 0 : fits ? column + 1 : 2) + word.size();
        out += word;
        words.remove_prefix(std::min(words.size(), word.size() + 1));
    }
    out += '\n';
}

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
        // Positions of 1e300 m are finite, but their squares are not.
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
        if (group != info.group) out += text(out.empty() ? "" : "\n", "## ", name(info.group), "\n\n");
        group = info.group;
        const char* better = info.better == Lower ? "lower" : info.better == Higher ? "higher" : "no direction";
        appendWrapped(out, text("- **", info.name, "** `", info.id, "` [", info.unit, "], ", better, " is better. ",
                                info.definition, " Source: ", info.source, ". Evidence: **", name(info.evidence),
                                "**. ", info.found));
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
    } else if (comparison.others < kMinOthers) {
        comparison.reason = text("needs ", kMinOthers, " other sessions, got ", comparison.others);
    } else if (comparison.deviation <= 1e-12 * std::abs(comparison.mean)) {
        comparison.reason = "all other sessions have the same number";
    } else {
        comparison.z = (*value.value - comparison.mean) / comparison.deviation;
    }
    return comparison;
}

} // namespace filasofia::metric
