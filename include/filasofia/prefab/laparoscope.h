#pragma once

#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/trocar.h"

namespace filasofia::prefab {

/// A rigid scope of 10 mm through a trocar: 0, 30 or 45 degrees, or any other inclination.
struct LaparoscopeDef {
    std::string name = "laparoscope";
    double inclination = 30.0 * std::numbers::pi / 180.0; ///< [rad], in [0, 1.5], angle between view and shaft
    double fieldOfView = 60.0 * std::numbers::pi / 180.0; ///< [rad], in [0.2, 2.6], over the height of the picture
    double zoom = 1.0; ///< [-], in [1, 4], how much larger the picture's middle is than without zoom
    /// The camera head turns against roll and tilt, so that what is up in the world is up in the picture.
    bool horizon = true;
    double intensity = 120.0; ///< [cd], > 0, intensity of its light along the view
    /// Mask, distortion, darkening to the rim; by default the picture is rectangular.
    visual::EndoscopeOptics optics = {
        .maskRadius = 2.0, .maskSoftness = 0.0, .distortion = 0.05, .vignette = 0.3, .rimBlur = 0.0};
    visual::EnvironmentDef surroundings = EndoscopeDef{}.surroundings; ///< light from all sides: walls of tissue
    std::vector<int> groups = {};                                      ///< collision groups; empty: it touches nothing
    visual::Quality quality = visual::Quality::High;
    TrocarDef trocar = {};
    TrocarHandleDef hand = {.length = 0.36};
    TrocarPose start = {.insertion = 0.05};
    std::optional<LensDef> soiling = {}; ///< how its lens becomes dirty; not given: never by itself
};
constexpr auto fields(const LaparoscopeDef*)
{
    using T = LaparoscopeDef;
    return describe("LaparoscopeDef", field("name", &T::name, "what errors and reports call it"),
                    field("inclination", &T::inclination, "rad", closed(0, 1.5), "angle between view and shaft"),
                    field("fieldOfView", &T::fieldOfView, "rad", closed(0.2, 2.6), "angle over the height"),
                    field("zoom", &T::zoom, "-", closed(1, 4), "how much larger the picture's middle is"),
                    field("horizon", &T::horizon, "whether the picture stays upright"),
                    field("intensity", &T::intensity, "cd", positive(), "intensity of its light"),
                    field("optics", &T::optics, "mask and distortion"),
                    field("surroundings", &T::surroundings, "light from all sides"),
                    field("groups", &T::groups, "collision groups of its models"),
                    field("quality", &T::quality, "quality of the effects"),
                    field("trocar", &T::trocar, "where it goes through the wall"),
                    field("hand", &T::hand, "how it is held"), field("start", &T::start, "its pose at the start"),
                    field("soiling", &T::soiling, "how its lens becomes dirty; not given: never"));
}

/// An Endoscope whose shaft goes through a trocar. An inclined one looks down if it is not rolled; its roll, as the
/// light post is turned, sweeps the view. A lens that was soiled is wiped when the scope is drawn back to within 5 mm
/// of its trocar's least insertion. Any thread may call all but dress(); poses take effect at the end of the next step.
class Laparoscope {
public:
    /// Throws an Error if the Def is wrong. Construct it before a run and destroy it before the simulation.
    Laparoscope(runtime::Simulation& simulation, const LaparoscopeDef& def = {});
    ~Laparoscope();
    Laparoscope(const Laparoscope&) = delete;
    Laparoscope& operator=(const Laparoscope&) = delete;

    [[nodiscard]] BodyId body() const; ///< elements Endoscope::kShaft and Endoscope::kCamera
    [[nodiscard]] const LaparoscopeDef& def() const;

    void move(const TrocarPose& pose); ///< as LaparoscopicInstrument::move()
    void zoom(double times);           ///< [-], in [1, 4] (Error otherwise)
    void horizon(bool keep);           ///< whether the camera head keeps the picture upright
    void soil(const LensState& lens);  ///< as Endoscope::soil()
    void wipe() { soil({}); }
    [[nodiscard]] LensState lens() const; ///< as of the last step

    [[nodiscard]] TrocarReport report() const; ///< as the last step left it
    [[nodiscard]] Pose camera() const;         ///< looks along -Z; +Y is up in the picture
    /// [rad], angle over the height of the picture with the present zoom: 2 atan(tan(fieldOfView / 2) / zoom).
    [[nodiscard]] double fieldOfView() const;
    [[nodiscard]] BodyId handle() const; ///< as LaparoscopicInstrument::handle()

    /// Makes its picture in the whole window. Call it from inside the function given to Simulation::dress().
    EndoscopeView dress(visual::VisualServer& server);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
