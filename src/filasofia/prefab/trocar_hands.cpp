#include "filasofia/prefab/trocar_hands.h"

#include "filasofia/core/published.h"
#include "filasofia/core/units.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/hand_script.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace filasofia::prefab {
namespace {

TrocarHandsDef checkedHands(TrocarHandsDef def)
{
    validate(def, "trocar hands");
    return def;
}

} // namespace

TrocarPoses between(const TrocarPoses& a, const TrocarPoses& b, double part)
{
    return {between(a.left, b.left, part), between(a.right, b.right, part), between(a.scope, b.scope, part)};
}

struct TrocarHands::Impl {
    enum Chosen { Left, Right, Scope };

    Impl(runtime::Simulation& sim, std::array<LaparoscopicInstrument*, 2> instruments, Laparoscope& camera,
         const TrocarHandsDef& asked)
        : simulation(sim), tools(instruments), scope(camera),
          def(checkedHands(asked)), now{tools[0]->def().start, tools[1]->def().start, scope.def().start}, wanted(now),
          script(now), newest(now)
    {
    }

    /// Before a step that ends at `time`.
    void step(double time)
    {
        // While another thread changes the hands, they rest; the next step makes up for it.
        turns.now([&] {
            const double dt = time - std::exchange(last, time);
            now =
                script.empty() ? between(now, wanted, 1.0 - std::exp(-dt / kHandFollow)) : script.follow(time - dt, dt);
            limit(now);
            if (!tools[0]->handle()) tools[0]->move(now.left);
            if (!tools[1]->handle()) tools[1]->move(now.right);
            if (!scope.handle()) scope.move(now.scope);
            newest.write(now);
        });
    }
    void limit(TrocarPoses& poses) const
    {
        poses.left = withinLimits(tools[0]->def().trocar, poses.left);
        poses.right = withinLimits(tools[1]->def().trocar, poses.right);
        poses.scope = withinLimits(scope.def().trocar, poses.scope);
    }

    // A person: events set the wanted pose, and every step moves part of the way.
    void shift(const TrocarPose& by)
    {
        turns.take(mayWait(), [this, by, which = chosen.load()] {
            TrocarPose& pose = which == Left ? wanted.left : which == Right ? wanted.right : wanted.scope;
            pose = {pose.yaw + by.yaw, pose.pitch + by.pitch, pose.insertion + by.insertion, pose.roll + by.roll};
            limit(wanted);
        });
    }
    void turn(const event::MouseMoveEvent& moved)
    {
        if (moved.buttons.right) shift({.yaw = def.gain * moved.dx, .pitch = -def.gain * moved.dy});
    }
    void press(const event::MouseButtonEvent& button)
    {
        if (button.button == event::MouseButton::Left && chosen != Scope) setJaws(chosen, button.pressed);
    }
    void press(const event::KeyEvent& key)
    {
        using event::KeyCode;
        if (!key.pressed) return;
        if (key.key == KeyCode::Digit1) chosen = Left;
        if (key.key == KeyCode::Digit2) chosen = Right;
        if (key.key == KeyCode::Digit3) chosen = Scope;
        if (key.key == KeyCode::W) shift({.insertion = 2_mm});
        if (key.key == KeyCode::S) shift({.insertion = -2_mm});
        if (key.key == KeyCode::A) shift({.roll = 5_deg});
        if (key.key == KeyCode::D) shift({.roll = -5_deg});
        if (key.key == KeyCode::PageUp) zoom(1.1);
        if (key.key == KeyCode::PageDown) zoom(1.0 / 1.1);
        if (key.key == KeyCode::G && !key.repeat && chosen != Scope)
            setJaws(chosen, !closed[static_cast<std::size_t>(chosen.load())]);
    }
    void press(const runtime::DeviceEvent& device)
    {
        if (device.notice.kind != device::DeviceNotice::Kind::Button || device.notice.button != 0) return;
        if (device.interface == def.leftDevice) setJaws(Left, device.notice.pressed);
        if (device.interface == def.rightDevice) setJaws(Right, device.notice.pressed);
    }
    void setJaws(int hand, bool close)
    {
        const auto which = static_cast<std::size_t>(hand);
        closed[which] = close;
        close ? tools[which]->tool().close() : tools[which]->tool().open();
    }
    void zoom(double by)
    {
        zoomed = std::clamp(zoomed * by, 1.0, 4.0);
        scope.zoom(zoomed);
    }
    [[nodiscard]] bool mayWait() const { return !simulation.physics().stepsHere(); }

    runtime::Simulation& simulation;
    const std::array<LaparoscopicInstrument*, 2> tools;
    Laparoscope& scope;
    const TrocarHandsDef def;
    std::atomic<int> chosen = Right;
    std::array<bool, 2> closed = {}; ///< used by the thread that delivers events, as the next one
    double zoomed = 1.0;
    Turns turns; // guards the members below
    TrocarPoses now, wanted;
    double last = 0.0; ///< [s], end of the last step
    HandScript<TrocarMove> script;
    Published<TrocarPoses> newest; // for all threads
};

TrocarHands::TrocarHands(runtime::Simulation& simulation, LaparoscopicInstrument& left, LaparoscopicInstrument& right,
                         Laparoscope& scope, const TrocarHandsDef& def)
    : impl_(std::make_shared<Impl>(simulation, std::array{&left, &right}, scope, def))
{
    const auto when = [weak = std::weak_ptr(impl_)](auto act) {
        return [weak, act](const auto& what) {
            if (const auto impl = weak.lock()) act(*impl, what);
        };
    };
    simulation.everyStep(when([](Impl& impl, double time) { impl.step(time); }));
    simulation.remember(
        {.of = "trocar hands",
         .save = [weak = std::weak_ptr(impl_)] { return weak.expired() ? std::any() : std::any(0); },
         .restore = [](const std::any&) {},
         .check = [](const std::any&) { fail("restore: hands hold instruments, and do not go back"); }});
    simulation.on<event::MouseMoveEvent>(when([](Impl& impl, const event::MouseMoveEvent& e) { impl.turn(e); }));
    simulation.on<event::MouseButtonEvent>(when([](Impl& impl, const event::MouseButtonEvent& e) { impl.press(e); }));
    simulation.on<event::MouseWheelEvent>(
        when([](Impl& impl, const event::MouseWheelEvent& e) { impl.shift({.insertion = 3_mm * e.dy}); }));
    simulation.on<event::KeyEvent>(when([](Impl& impl, const event::KeyEvent& e) { impl.press(e); }));
    simulation.on<runtime::DeviceEvent>(when([](Impl& impl, const runtime::DeviceEvent& e) { impl.press(e); }));
}
TrocarHands::~TrocarHands() = default;

void TrocarHands::play(std::vector<TrocarMove> moves)
{
    checkMoves(moves, "trocar hands");
    impl_->turns.take(impl_->mayWait(),
                      [impl = impl_.get(), moves = std::move(moves)] { impl->script.play(moves, impl->now); });
}

TrocarPoses TrocarHands::wanted() const { return impl_->newest.read(); }

} // namespace filasofia::prefab
