#include "filasofia/engine/rupture/rupture_report.h"

namespace filasofia::engine {

RuptureReport& RuptureReport::operator+=(const RuptureReport& b)
{
    for (int i = 0; i < kRuptureRefusals; ++i) refused[i] += b.refused[i];
    for (long RuptureReport::*sum :
         {&RuptureReport::crossings, &RuptureReport::snapped, &RuptureReport::snappedGuard, &RuptureReport::moves,
          &RuptureReport::bisections, &RuptureReport::flagged, &RuptureReport::edits, &RuptureReport::repairedEdits,
          &RuptureReport::repairRounds, &RuptureReport::repairBisections, &RuptureReport::repairFlips,
          &RuptureReport::repairSlits, &RuptureReport::repairDeferred, &RuptureReport::flakes, &RuptureReport::givenUp,
          &RuptureReport::openedFaces, &RuptureReport::copies, &RuptureReport::inVain})
        this->*sum += b.*sum;
    pending = b.pending; // pending now, not summed
    openedArea += b.openedArea;
    openedMoment += b.openedMoment;
    return *this;
}

void add(const RuptureReport& from, physics::TopologyReport& to)
{
    const auto refused = [&](RuptureRefusal why) { return static_cast<int>(from.refused[static_cast<int>(why)]); };
    to.bladeNotFinite += refused(RuptureRefusal::BladeNotFinite);
    to.bladeNoLength += refused(RuptureRefusal::BladeNoLength);
    to.bladeJump += refused(RuptureRefusal::BladeJump);
    to.edgeGone += refused(RuptureRefusal::EdgeGone);
    to.tearClosed += refused(RuptureRefusal::TearClosed);
    to.inVain += static_cast<int>(from.inVain);
    to.putOff += static_cast<int>(from.repairDeferred);
    to.pending += static_cast<int>(from.pending);
}

void moveRupture(physics::Rupture::Kind kind, BodyId body, RuptureReport& opened, physics::TopologyReport& to)
{
    if (opened.openedArea > 0.0)
        to.ruptures.push_back({.kind = kind,
                               .body = body,
                               .place = 1.0 / opened.openedArea * opened.openedMoment,
                               .area = opened.openedArea});
    opened = {};
}

} // namespace filasofia::engine
