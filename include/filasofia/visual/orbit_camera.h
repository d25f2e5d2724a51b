#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/input_events.h"
#include "filasofia/geometry/box.h"
#include "filasofia/math/pose.h"

#include <numbers>

namespace filasofia::visual {

struct OrbitDef {
    geometry::Box around = {{-0.1, -0.1, -0.1},
                            {0.1, 0.1, 0.1}}; ///< [m], the scene: F frames it, and limits scale with it
    Pose start = {{0, 0, 0.5}, {}};           ///< start pose of the camera, which looks along -Z
    double verticalFieldOfView = 60.0 * std::numbers::pi / 180.0; ///< [rad], in [0.01, 3], of the camera
    int width = 960;                                              ///< [px], in [1, 8192], of the picture
    int height = 720;                                             ///< [px], in [1, 8192]
    double closest = 0.1;   ///< [-], > 0, smallest distance to the target, in radii of `around`
    double farthest = 10.0; ///< [-], > closest, largest distance, in radii of `around`
};
constexpr auto fields(const OrbitDef*)
{
    using T = OrbitDef;
    return describe(
        "OrbitDef", field("around", &T::around, "the scene"), field("start", &T::start, "where the camera begins"),
        field("verticalFieldOfView", &T::verticalFieldOfView, "rad", closed(0.01, 3),
              "vertical field of view of the camera"),
        field("width", &T::width, "px", closed(1, 8192), "size of the picture"),
        field("height", &T::height, "px", closed(1, 8192), "size of the picture"),
        field("closest", &T::closest, "-", positive(), "smallest distance to the target, in radii of the scene"),
        field("farthest", &T::farthest, "-", positive(), "largest distance to the target, in radii of the scene"));
}

/// Turns what a person does with mouse and keys into the pose of a camera. It knows no window and no server; +Y stays
/// up.
///
/// Left drag rotates about the target; middle drag, or left with Shift, shifts, so that what lies at the target's depth
/// stays under the mouse; the wheel zooms; F frames the scene; Home returns to the start. The right button and input
/// with Control, Alt or Super are not used.
class OrbitCamera {
public:
    /// [rad], largest angle of the view from above or below.
    static constexpr double kSteepest = 89.0 * std::numbers::pi / 180.0;
    static constexpr double kNotch = 0.85; ///< [-], factor on the distance for one notch of the wheel

    /// Throws an Error naming the field that is out of range.
    explicit OrbitCamera(const OrbitDef& def);

    /// Returns whether the event was for the camera. A drag counts only if its press came here, so that one that began
    /// on a button of a Gui does not rotate the camera.
    bool handle(const event::Event& event);
    /// The scene has moved or has another size. Ignored if the box is empty, not finite or a point.
    void setScene(const geometry::Box& around);

    [[nodiscard]] Pose pose() const; ///< the camera's; bit-identical to the start until it is moved
    [[nodiscard]] Vec3 target() const { return target_; }
    [[nodiscard]] double distance() const { return distance_; } ///< [m], from the target

private:
    enum class Drag { None, Turn, Shift };

    bool press(const event::MouseButtonEvent& event);
    bool move(const event::MouseMoveEvent& event);
    bool key(const event::KeyEvent& event);
    void goToStart();
    void frameAll();
    void shift(double right, double up); ///< [px], by which the target moves in the picture
    void limit();
    [[nodiscard]] double perPixel() const; ///< [m], size of a pixel at the target's depth

    OrbitDef def_;
    Vec3 middle_;
    double radius_ = 0.0; ///< [m], radius of the scene
    Vec3 target_;
    double distance_ = 0.0;  ///< [m]
    double azimuth_ = 0.0;   ///< [rad], about +Y, from +Z towards +X
    double elevation_ = 0.0; ///< [rad], towards +Y
    bool moved_ = false;
    Drag drag_ = Drag::None;
    event::MouseButton button_ = event::MouseButton::Left; ///< the button that drags
};

} // namespace filasofia::visual
