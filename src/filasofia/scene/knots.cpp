#include "filasofia/scene/knots.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/remember_past.h"
#include "filasofia/scene/scene_numbers.h"

namespace filasofia::scene {
namespace {

/// Lets hands begin and let go when the times have come.
class KnotFollower {
public:
    KnotFollower(runtime::Simulation& simulation, const SceneKnot& knot)
        : begin_(knot.begin), release_(knot.release), hands_(simulation, knot.def)
    {
    }

    void follow(double time)
    {
        if (past_ == 0 && time >= begin_) {
            hands_.begin();
            past_ = 1;
        }
        if (past_ == 1 && release_ && time >= *release_) {
            hands_.release();
            past_ = 2;
        }
    }

    [[nodiscard]] int past() const { return past_; }
    void goBack(int past) { past_ = past; }

private:
    double begin_;
    std::optional<double> release_;
    prefab::KnotHands hands_;
    int past_ = 0; ///< 1: the hands have begun, 2: they have let go
};

void addKnot(runtime::Simulation& simulation, SceneKnot knot, const std::vector<BodyId>& ids)
{
    if (!knot.def.thread) fail("thread must be a body of the scene");
    SceneNumbers(ids).replaceIn(knot);
    if (knot.release && !(*knot.release > knot.begin))
        fail("release must be > begin = ", knot.begin, " s, got ", *knot.release);
    const auto follower = std::make_shared<KnotFollower>(simulation, knot);
    simulation.everyStep([follower](double time) { follower->follow(time); });
    rememberPast(simulation, text("the times of knot '", knot.def.name, "'"), follower);
}

} // namespace

void addKnots(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids)
{
    for (std::size_t i = 0; i < scene.knots.size(); ++i) try {
            addKnot(simulation, scene.knots[i], ids);
        } catch (const Error& error) {
            const std::string path = text("knots[", i, "]");
            failAtPlace(scene.places, path, text(path, ": ", error.what()));
        }
}

} // namespace filasofia::scene
