#pragma once

#include "filasofia/metric/catalog.h"
#include "filasofia/metric/motion.h"

/// The functions behind the catalog, and what they share.
namespace filasofia::metric {

/// What is computed once per session for all metrics.
struct Material {
    const Session& session;
    const MeasureDef& def;
    const Track* tool = nullptr;    ///< nullptr if none is observed
    const Track* partner = nullptr; ///< the tool in the other hand
    const Track* scope = nullptr;
    std::vector<Motion> motions = {}; ///< motions of the tool
    double moved = 0.0;               ///< [s], the sum of their durations
    double first = 0.0, last = 0.0;   ///< [s], first and last time of the tool's samples that have a finite time
    int timed = 0;                    ///< [-], number of samples that have a finite time
};
Material materialOf(const Session& session, const MeasureDef& def);

inline Value found(double value, std::optional<double> moment = {}) { return {value, {}, moment}; }
inline Value none(std::string reason) { return {{}, std::move(reason), {}}; }

// Economy of motion.
Value duration(const Material&);
Value pathLength(const Material&);
Value depthPath(const Material&);
Value economy(const Material&);
Value meanSpeed(const Material&);
Value peakSpeed(const Material&);
Value idleShare(const Material&);
Value longestRest(const Material&);
Value workingVolume(const Material&);
Value bimanualCorrelation(const Material&);
// Smoothness.
Value sparc(const Material&);
Value logDimensionlessJerk(const Material&);
Value motionFrequency(const Material&);
Value speedPeaks(const Material&);
// Force.
Value maxForce(const Material&);
Value meanForce(const Material&);
Value rmsForce(const Material&);
Value forceImpulse(const Material&);
Value timeAboveLimit(const Material&);
Value timesAboveLimit(const Material&);
Value contactCount(const Material&);
Value contactTime(const Material&);
Value longestContact(const Material&);
Value meanContactPeak(const Material&);
// Safety.
Value perforations(const Material&);
Value unintendedTears(const Material&);
Value unintendedCuts(const Material&);
Value unintendedArea(const Material&);
Value bloodLost(const Material&);
Value ductLeak(const Material&);
Value fluidDeficit(const Material&);
Value clipsPlaced(const Material&);
Value clipsLost(const Material&);
Value clipsSlipped(const Material&);
Value unintendedBurn(const Material&);
Value activationTime(const Material&);
Value activationInAir(const Material&);
Value energyDelivered(const Material&);
Value volumeRemoved(const Material&);
// View.
Value horizonError(const Material&);
Value lensContactTime(const Material&);
Value outOfViewTime(const Material&);
Value shareSeen(const Material&);
// Task.
Value stepsDone(const Material&);
Value mistakes(const Material&);
Value residual(const Material&);

} // namespace filasofia::metric
