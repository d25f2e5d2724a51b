#include "filasofia/visual/orbit_camera.h"

#include "filasofia/core/validate.h"
#include "filasofia/visual/transform.h"

#include <algorithm>
#include <cmath>

namespace filasofia::visual {
namespace {

constexpr double kReach = 2.0; ///< [radii], largest distance of the target from the scene's centre

bool usable(const geometry::Box& box)
{
    return !geometry::isEmpty(box) && isFinite(box.low) && isFinite(box.high) && box.low != box.high;
}

bool foreign(const event::Modifiers& held) { return held.control || held.alt || held.super; }

} // namespace

OrbitCamera::OrbitCamera(const OrbitDef& def) : def_(def)
{
    validate(def, "orbit camera");
    if (!usable(def.around)) fail("orbit camera: around must be a finite box with high > low in some axis");
    if (!(def.farthest > def.closest))
        fail("orbit camera: farthest must be > closest ", def.closest, ", got ", def.farthest);
    setScene(def.around);
    goToStart();
}

void OrbitCamera::setScene(const geometry::Box& around)
{
    if (!usable(around)) return;
    middle_ = 0.5 * (around.low + around.high);
    radius_ = 0.5 * filasofia::distance(around.low, around.high);
}

void OrbitCamera::goToStart()
{
    // It rotates about the point of its line of sight that is nearest to the scene's centre.
    const Vec3 back = rotate(def_.start.orientation, Vec3{0, 0, 1});
    azimuth_ = std::atan2(back.x, back.z);
    elevation_ = std::asin(std::clamp(back.y, -1.0, 1.0));
    distance_ = dot(def_.start.position - middle_, back);
    limit();
    target_ = def_.start.position - distance_ * back;
    moved_ = false;
}

void OrbitCamera::frameAll()
{
    // The sphere around the scene touches the picture's nearer edges.
    const double half = 0.5 * def_.verticalFieldOfView;
    const double across = std::atan(std::tan(half) * def_.width / def_.height);
    target_ = middle_;
    distance_ = radius_ / std::sin(std::min(half, across));
    moved_ = true;
    limit();
}

void OrbitCamera::limit()
{
    elevation_ = std::clamp(elevation_, -kSteepest, kSteepest);
    distance_ = std::clamp(distance_, def_.closest * radius_, def_.farthest * radius_);
    const Vec3 off = target_ - middle_;
    if (const double far = length(off); moved_ && far > kReach * radius_)
        target_ = middle_ + (kReach * radius_ / far) * off;
}

double OrbitCamera::perPixel() const
{
    return 2.0 * distance_ * std::tan(0.5 * def_.verticalFieldOfView) / def_.height;
}

void OrbitCamera::shift(double right, double up)
{
    const Quat orientation = pose().orientation;
    target_ += perPixel() * (right * rotate(orientation, Vec3{1, 0, 0}) + up * rotate(orientation, Vec3{0, 1, 0}));
}

Pose OrbitCamera::pose() const
{
    if (!moved_) return def_.start;
    const Vec3 back{std::cos(elevation_) * std::sin(azimuth_), std::sin(elevation_),
                    std::cos(elevation_) * std::cos(azimuth_)};
    return lookAt(target_ + distance_ * back, target_);
}

bool OrbitCamera::handle(const event::Event& event)
{
    if (const auto* button = dynamic_cast<const event::MouseButtonEvent*>(&event)) return press(*button);
    if (const auto* mouse = dynamic_cast<const event::MouseMoveEvent*>(&event)) return move(*mouse);
    if (const auto* pressed = dynamic_cast<const event::KeyEvent*>(&event)) return key(*pressed);
    if (const auto* wheel = dynamic_cast<const event::MouseWheelEvent*>(&event)) {
        if (foreign(wheel->modifiers) || wheel->dy == 0.0) return false;
        distance_ *= std::pow(kNotch, wheel->dy);
        moved_ = true;
        limit();
        return true;
    }
    if (const auto* window = dynamic_cast<const event::WindowEvent*>(&event)) {
        if (window->width > 0 && window->height > 0) {
            def_.width = window->width;
            def_.height = window->height;
        }
        if (window->kind == event::WindowEvent::Kind::FocusLost) drag_ = Drag::None; // its release goes elsewhere
    }
    return false;
}

bool OrbitCamera::press(const event::MouseButtonEvent& event)
{
    using event::MouseButton;
    if (!event.pressed) {
        if (drag_ == Drag::None || event.button != button_) return false;
        drag_ = Drag::None;
        return true;
    }
    if (drag_ != Drag::None || foreign(event.modifiers)) return false;
    const bool left = event.button == MouseButton::Left;
    if (!left && event.button != MouseButton::Middle) return false;
    drag_ = left && !event.modifiers.shift ? Drag::Turn : Drag::Shift;
    button_ = event.button;
    return true;
}

bool OrbitCamera::move(const event::MouseMoveEvent& event)
{
    if (drag_ == Drag::None) return false;
    moved_ = true;
    if (drag_ == Drag::Turn) {
        const double angle = std::numbers::pi / def_.height; // half a turn over the height of the picture
        azimuth_ = std::remainder(azimuth_ - angle * event.dx, 2.0 * std::numbers::pi);
        elevation_ += angle * event.dy;
    } else {
        shift(-event.dx, event.dy);
    }
    limit();
    return true;
}

bool OrbitCamera::key(const event::KeyEvent& event)
{
    const bool ours = event.key == event::KeyCode::F || event.key == event::KeyCode::Home;
    if (!ours || !event.pressed || foreign(event.modifiers)) return false;
    event.key == event::KeyCode::F ? frameAll() : goToStart();
    return true;
}

} // namespace filasofia::visual
