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
          &RuptureReport::openedFaces, &RuptureReport::copies})
        this->*sum += b.*sum;
    pending = b.pending; // pending now, not summed
    openedArea += b.openedArea;
    openedMoment += b.openedMoment;
    return *this;
}

} // namespace filasofia::engine
