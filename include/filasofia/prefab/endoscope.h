#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// A rigid endoscope. It points along -Z and its shaft lies at +Z of its tip; an inclined one looks down, towards -Y.
struct EndoscopeDef {
    std::string name = "endoscope";
    Pose pose = {}; ///< of its tip at the start, in the world
    /// Drawn, in the tip's coordinates; none: a hysteroscope of 5 mm, made for 30 degrees.
    std::vector<runtime::SurfaceSource> surfaces = {};
    physics::TriangleMeshSource collision = {};           ///< by what it touches, in those; empty: that hysteroscope's
    std::vector<int> groups = {0};                        ///< of its collision models; none: it touches nothing
    double proximity = 0.2e-3;                            ///< [m], >= 0
    double friction = 0.05;                               ///< [-], >= 0: it is wet
    Vec3 lens = {0.0, 0.97e-3, 0.7e-3};                   ///< [m], in the tip's coordinates
    double inclination = 30.0 * std::numbers::pi / 180.0; ///< [rad], in [0, 1.5], of the view against the shaft
    double fieldOfView = 80.0 * std::numbers::pi / 180.0; ///< [rad], in [0.2, 2.6], of the height of the picture
    double intensity = 1.6;                               ///< [cd], > 0, of its light, on the axis of the view
    visual::Color lightColor = {1.0, 0.96, 0.90};
    visual::EndoscopeOptics optics = {}; ///< mask, distortion, darkening to the rim
    visual::Quality quality = visual::Quality::High;
    Pose channel = {{0.0, -1.5e-3, 2.3e-3}, {}}; ///< the mouth of the working channel, in the tip's coordinates;
                                                 ///< instruments leave it along its -Z
};
constexpr auto fields(const EndoscopeDef*)
{
    using T = EndoscopeDef;
    return describe(
        "EndoscopeDef", field("name", &T::name, "what errors and reports call it"),
        field("pose", &T::pose, "of its tip at the start"), field("surfaces", &T::surfaces, "what is drawn"),
        field("collision", &T::collision, "by what it touches"), field("groups", &T::groups, "of its collision models"),
        field("proximity", &T::proximity, "m", nonNegative(), "from where on contacts are found"),
        field("friction", &T::friction, "-", nonNegative(), "mu of Coulomb's law"),
        field("lens", &T::lens, "m", finite(), "where the camera is, from the tip"),
        field("inclination", &T::inclination, "rad", closed(0, 1.5), "of the view against the shaft"),
        field("fieldOfView", &T::fieldOfView, "rad", closed(0.2, 2.6), "of the height of the picture"),
        field("intensity", &T::intensity, "cd", positive(), "of its light"),
        field("lightColor", &T::lightColor, "of its light"), field("optics", &T::optics, "mask, distortion, darkening"),
        field("quality", &T::quality, "effects"), field("channel", &T::channel, "mouth of the working channel"));
}

/// What dress() made.
struct EndoscopeView {
    visual::Camera* camera = nullptr;
    visual::Light* light = nullptr;
    visual::View* view = nullptr;
};

/// A shaft that goes where it is told, with a camera and a light at its tip.
///
/// The shaft is element kShaft of a rigid body. The camera is element kCamera of the same body, so that what it sees is
/// part of every recording, and a MetricTracker can follow it. Every function but dress() may be called from any
/// thread; what moves takes effect at the end of the next step.
class Endoscope {
public:
    static constexpr int kShaft = 0;
    static constexpr int kCamera = 1;

    /// Adds and shows the body. Throws Error where the Def is wrong. To be destroyed before the simulation.
    Endoscope(runtime::Simulation& simulation, const EndoscopeDef& def = {});
    ~Endoscope();
    Endoscope(const Endoscope&) = delete;
    Endoscope& operator=(const Endoscope&) = delete;

    [[nodiscard]] BodyId body() const;

    /// The tip to a pose in the world, before roll().
    void move(const Pose& tip);
    /// Turns the whole scope about its shaft [rad], from where it was at the start; counter-clockwise as the camera of
    /// a straight one sees the scope, seen from behind. The view of an inclined one sweeps a cone.
    void roll(double angle);
    /// Turns the camera alone about the axis of its view [rad], against the shaft: what is seen stays, the picture
    /// turns. With minus the angle of roll() a straight scope's picture stays upright.
    void cameraRoll(double angle);

    // As they were told last.
    [[nodiscard]] Pose tip() const;     ///< with the roll
    [[nodiscard]] Pose camera() const;  ///< looks along -Z; +Y is up in the picture
    [[nodiscard]] Pose channel() const; ///< of the working channel's mouth

    /// Makes the endoscope's picture in the whole window, and surroundings as a cavity of tissue has them, lit by its
    /// own walls: from inside Simulation::dress.
    EndoscopeView dress(visual::VisualServer& server);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
