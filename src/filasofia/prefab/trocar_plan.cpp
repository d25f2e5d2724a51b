#include "filasofia/prefab/trocar_plan.h"

#include "filasofia/prefab/hand_move.h"

#include <utility>

namespace filasofia::prefab {

TrocarPose reach(const LaparoscopicInstrument& tool, Vec3 place, Vec3 point, Vec3 across, double back)
{
    const TrocarDef& trocar = tool.def().trocar;
    const Vec3 pivot = place + length(point) * normalized(trocar.fulcrum - place);
    TrocarPose pose = poseAt(trocar, place, rollAcross(trocar, pivot, across), point);
    pose.insertion -= back;
    return withinLimits(trocar, pose);
}

TrocarPlan::TrocarPlan(const LaparoscopicInstrument& left, const LaparoscopicInstrument& right,
                       const Laparoscope& scope)
    : goal_(std::make_shared<TrocarPoses>(TrocarPoses{left.def().start, right.def().start, scope.def().start})),
      trocars_{left.def().trocar, right.def().trocar}
{
}

TrocarMove& TrocarPlan::add(double seconds, TrocarAim left, TrocarAim right)
{
    const auto aim = [goal = goal_, trocars = trocars_, left = std::move(left), right = std::move(right)] {
        if (left) goal->left = withinLimits(trocars[0], left());
        if (right) goal->right = withinLimits(trocars[1], right());
        return *goal;
    };
    return moves_.emplace_back(TrocarMove{.seconds = seconds, .aim = aim});
}

double TrocarPlan::seconds() const { return durationOf(moves_); }

} // namespace filasofia::prefab
