#include "filasofia/scene/knots.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/has_come.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/remember_past.h"
#include "filasofia/scene/scene_numbers.h"

namespace filasofia::scene {
namespace {

/// Lets hands begin and let go when the times have come.
template <class Hands> class KnotFollower {
public:
    template <class Def> KnotFollower(runtime::Simulation& simulation, const SceneKnot& knot, const Def& def)
        : begin_(knot.begin), release_(knot.release), hands_(simulation, def)
    {
    }

    void follow(double time)
    {
        if (past_ == 0 && hasCome(begin_, time)) {
            hands_.begin();
            past_ = 1;
        }
        if (past_ == 1 && release_ && hasCome(*release_, time)) {
            hands_.release();
            past_ = 2;
        }
    }

    [[nodiscard]] int tied() const { return hands_.tied(); }
    [[nodiscard]] double largestForce() const { return hands_.largestForce(); }
    [[nodiscard]] int past() const { return past_; }
    void goBack(int past) { past_ = past; }

private:
    double begin_;
    std::optional<double> release_;
    Hands hands_;
    int past_ = 0; ///< 1: the hands have begun, 2: they have let go
};

using Progress = std::function<SceneKnotProgress()>;

template <class Hands, class Def>
Progress follow(runtime::Simulation& simulation, const SceneKnot& knot, const Def& def)
{
    const auto follower = std::make_shared<KnotFollower<Hands>>(simulation, knot, def);
    simulation.everyStep([follower](double time) { follower->follow(time); });
    rememberPast(simulation, text("the times of knot '", def.name, "'"), follower);
    return [follower, name = def.name, throws = static_cast<int>(def.turns.size())] {
        return SceneKnotProgress{name, throws, follower->tied(), follower->largestForce()};
    };
}

struct KnotAdder {
    runtime::Simulation& simulation;
    const SceneKnot& knot;

    Progress operator()(const prefab::KnotDef& def) const { return follow<prefab::KnotHands>(simulation, knot, def); }
    Progress operator()(const prefab::InstrumentTieDef& def) const
    {
        return follow<prefab::InstrumentTie>(simulation, knot, def);
    }
};

Progress addKnot(runtime::Simulation& simulation, SceneKnot knot, const std::vector<BodyId>& ids)
{
    if (!std::visit([](const auto& def) { return def.thread; }, knot.def)) fail("thread must be a body of the scene");
    SceneNumbers(ids).replaceIn(knot);
    if (knot.release && !(*knot.release > knot.begin))
        fail("release must be > begin = ", knot.begin, " s, got ", *knot.release);
    return std::visit(KnotAdder{simulation, knot}, knot.def);
}

} // namespace

std::vector<Progress> addKnots(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids)
{
    std::vector<Progress> knots;
    for (std::size_t i = 0; i < scene.knots.size(); ++i) try {
            knots.push_back(addKnot(simulation, scene.knots[i], ids));
        } catch (const Error& error) {
            const std::string path = text("knots[", i, "]");
            failAtPlace(scene.places, path, text(path, ": ", error.what()));
        }
    return knots;
}

} // namespace filasofia::scene
