#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// How a lens becomes dirty. No constant is measured.
struct LensDef {
    double reach = 6e-3;    ///< [m], > 0, from the lens: soft bodies that the scope touches there smear it
    double smearing = 0.4;  ///< [s], > 0, of touching in which 1 - 1/e of the lens is smeared
    double cold = 0.0;      ///< [-], in [0, 1], how fogged it is at the start: a scope that was not warmed
    double misting = 200.0; ///< [s/m], > 0, optical depth per length of smoke, times how long, that fogs it to 1 - 1/e
    double clearing = 25.0; ///< [s], > 0, in which it becomes clear to 1/e, by its own warmth; may be infinite
};
constexpr auto fields(const LensDef*)
{
    using T = LensDef;
    return describe("LensDef", field("reach", &T::reach, "m", positive(), "from the lens: what touches it smears it"),
                    field("smearing", &T::smearing, "s", positive(), "of touching smears 1 - 1/e of the lens"),
                    field("cold", &T::cold, "-", closed(0, 1), "how fogged it is at the start"),
                    field("misting", &T::misting, "s/m", positive(), "smoke times time that fogs it to 1 - 1/e"),
                    field("clearing", &T::clearing, "s", positiveOrInfinite(), "in which fog clears to 1/e"));
}

/// How dirty a lens is.
struct LensState {
    double mist = 0.0;  ///< [-], in [0, 1], how fogged it is
    double smear = 0.0; ///< [-], in [0, 1], share of it that is smeared
    friend bool operator==(const LensState&, const LensState&) = default;
};

/// A rigid endoscope. It points along -Z and its shaft lies at +Z of its tip; an inclined one looks down, towards -Y.
struct EndoscopeDef {
    std::string name = "endoscope";
    Pose pose = {}; ///< pose of its tip at the start, in the world
    /// The drawn surfaces, in the tip's coordinates; empty: a hysteroscope of 5 mm, made for 30 degrees.
    std::vector<runtime::SurfaceSource> surfaces = {};
    physics::TriangleMeshSource collision = {}; ///< collision mesh in the tip's coordinates; empty: that hysteroscope's
    std::vector<int> groups = {0};              ///< collision groups of its models; empty: it touches nothing
    double proximity = 0.2e-3;                  ///< [m], >= 0, distance at which contacts are found
    double friction = 0.05;                     ///< [-], >= 0, coefficient of friction; low because the scope is wet
    Vec3 lens = {0.0, 0.97e-3, 0.7e-3};         ///< [m], in the tip's coordinates
    double inclination = 30.0 * std::numbers::pi / 180.0; ///< [rad], in [0, 1.5], angle between view and shaft
    double fieldOfView = 80.0 * std::numbers::pi / 180.0; ///< [rad], in [0.2, 2.6], over the height of the picture
    double intensity = 1.6;                               ///< [cd], > 0, intensity of its light along the view
    visual::Color lightColor = {1.0, 0.96, 0.90};
    Vec3 lamp = {0.8e-3, 0.0, 0.0};      ///< [m], middle of the light, from the lens; beside it, lit tissue has shading
    visual::EndoscopeOptics optics = {}; ///< mask, distortion, darkening to the rim
    visual::Quality quality = visual::Quality::High;
    double focusDistance = 0.02; ///< [m], > 0, distance that is sharp
    /// The walls reflect light, which tissue makes red. Without this light instruments are black and shadows have no
    /// end.
    visual::EnvironmentDef surroundings = {.intensity = 300.0,
                                           .above = {0.55, 0.36, 0.32},
                                           .below = {0.45, 0.25, 0.21},
                                           .lampStrength = 1.0,
                                           .background = {0.03, 0.006, 0.005}};
    /// Mouth of the working channel, in the tip's coordinates; instruments leave it along its -Z.
    Pose channel = {{0.0, -1.5e-3, 2.3e-3}, {}};
    std::optional<LensDef> soiling = {}; ///< how its lens becomes dirty; not given: never by itself
};
constexpr auto fields(const EndoscopeDef*)
{
    using T = EndoscopeDef;
    return describe(
        "EndoscopeDef", field("name", &T::name, "what errors and reports call it"),
        field("pose", &T::pose, "pose of its tip at the start"), field("surfaces", &T::surfaces, "what is drawn"),
        field("collision", &T::collision, "collision mesh"),
        field("groups", &T::groups, "collision groups of its models"),
        field("proximity", &T::proximity, "m", nonNegative(), "distance at which contacts are found"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction), "mu of Coulomb's law"),
        field("lens", &T::lens, "m", finite(), "place of the camera, from the tip"),
        field("inclination", &T::inclination, "rad", closed(0, 1.5), "angle between view and shaft"),
        field("fieldOfView", &T::fieldOfView, "rad", closed(0.2, 2.6), "angle over the height of the picture"),
        field("intensity", &T::intensity, "cd", positive(), "intensity of its light"),
        field("lightColor", &T::lightColor, "color of its light"),
        field("lamp", &T::lamp, "m", finite(), "middle of the light, from the lens"),
        field("optics", &T::optics, "mask, distortion, darkening"),
        field("quality", &T::quality, "quality of the effects"),
        field("focusDistance", &T::focusDistance, "m", positive(), "distance that is sharp"),
        field("surroundings", &T::surroundings, "light from all sides"),
        field("channel", &T::channel, "mouth of the working channel"),
        field("soiling", &T::soiling, "how its lens becomes dirty; not given: never"));
}

/// The entities that dress() made.
struct EndoscopeView {
    visual::Camera* camera = nullptr;
    visual::Light* light = nullptr;
    visual::View* view = nullptr;
};

/// A kinematic shaft with a camera and a light at its tip.
///
/// The shaft is element kShaft of a rigid body. The camera is element kCamera of the same body, so that every recording
/// contains what it sees and a MetricTracker can follow it. Every function but dress() may be called from any thread;
/// motions take effect at the end of the next step.
class Endoscope {
public:
    static constexpr int kShaft = 0;
    static constexpr int kCamera = 1;

    /// Adds and shows the body. Throws an Error if the Def is wrong. Destroy it before the simulation.
    Endoscope(runtime::Simulation& simulation, const EndoscopeDef& def = {});
    ~Endoscope();
    Endoscope(const Endoscope&) = delete;
    Endoscope& operator=(const Endoscope&) = delete;

    [[nodiscard]] BodyId body() const;

    /// Moves the tip to a pose in the world; roll() is applied on top.
    void move(const Pose& tip);
    /// Rotates the whole scope about its shaft by an angle [rad] from its start. Positive is counter-clockwise seen
    /// from behind the scope. The view of an inclined scope sweeps a cone.
    void roll(double angle);
    /// Rotates only the camera about its view axis [rad], relative to the shaft: the view stays, the picture rotates.
    /// With the negative angle of roll() a straight scope's picture stays upright.
    void cameraRoll(double angle);

    // The last commanded poses.
    [[nodiscard]] Pose tip() const;     ///< with the roll
    [[nodiscard]] Pose camera() const;  ///< looks along -Z; +Y is up in the picture
    [[nodiscard]] Pose channel() const; ///< mouth of the working channel

    /// Makes the lens as dirty as this, from the next step on; both in [0, 1] (Error otherwise).
    void soil(const LensState& lens);
    void wipe() { soil({}); }
    [[nodiscard]] LensState lens() const; ///< as of the last step

    /// Makes the endoscope's picture in the whole window, in the surroundings of a cavity of tissue that its own walls
    /// light. Call it from inside the function given to Simulation::dress().
    EndoscopeView dress(visual::VisualServer& server);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
