#pragma once

#include "filasofia/visual/material.h"
#include "filasofia/visual/transform.h"

#include <memory>
#include <numbers>

namespace filasofia::visual {

/// Shines in a cone along -Z of its pose.
struct SpotLight {
    double intensity = 40.0;                             ///< [cd], > 0, on the axis
    double innerAngle = 20.0 * std::numbers::pi / 180.0; ///< [rad], in (0, 1.5], half angle of full light
    double outerAngle = 40.0 * std::numbers::pi / 180.0; ///< [rad], in (0, 1.5], half angle at which the light ends
    double range = 1.0;                                  ///< [m], > 0, distance at which the light ends
};

constexpr auto fields(const SpotLight*)
{
    using L = SpotLight;
    return describe(
        "SpotLight", field("intensity", &L::intensity, "cd", positive(), "on the axis"),
        field("innerAngle", &L::innerAngle, "rad", openClosed(0, 1.5), "half angle of full light"),
        field("outerAngle", &L::outerAngle, "rad", openClosed(0, 1.5), "half angle at which the light ends"),
        field("range", &L::range, "m", positive(), "distance at which the light ends"));
}

/// Parallel light along -Z of its pose; at most one in a scene.
struct DirectionalLight {
    double illuminance = 10000.0; ///< [lx], > 0
};

constexpr auto fields(const DirectionalLight*)
{
    return describe("DirectionalLight",
                    field("illuminance", &DirectionalLight::illuminance, "lx", positive(), "on a facing surface"));
}

/// Shines in all directions; casts no shadows.
struct PointLight {
    double intensity = 40.0; ///< [cd], > 0
    double range = 1.0;      ///< [m], > 0, distance at which the light ends
};

constexpr auto fields(const PointLight*)
{
    return describe("PointLight", field("intensity", &PointLight::intensity, "cd", positive(), "to every side"),
                    field("range", &PointLight::range, "m", positive(), "distance at which the light ends"));
}

struct LightDef {
    std::string name = "light";
    std::variant<SpotLight, DirectionalLight, PointLight> kind = SpotLight{};
    Color color = {1.0, 0.96, 0.90};
    bool castShadows = true; ///< at most two spot lights of a scene can cast shadows
};

constexpr auto fields(const LightDef*)
{
    using D = LightDef;
    return describe("LightDef", field("name", &D::name, "name in errors"),
                    field("kind", &D::kind, "shape of the light"), field("color", &D::color, "colour of the light"),
                    field("castShadows", &D::castShadows, "whether bodies shade each other"));
}

/// A light; made by VisualServer::add. Main thread only.
class Light final : public Transform {
public:
    struct Impl;
    Light(std::string name, std::unique_ptr<Impl> impl);
    ~Light() override;

    [[nodiscard]] const LightDef& def() const;
    /// Throws an Error naming the light if a field is out of range, or if there would be one shadow-casting or
    /// directional light too many.
    void set(const LightDef& def);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// The surroundings that light the scene and mirror in it: dim light from all sides, with a gradient from above to
/// below, and one soft lamp. Everything is computed; there are no image files.
struct EnvironmentDef {
    double intensity = 220.0;              ///< [lx], >= 0, illuminance if the colours are 1
    Color above = {0.55, 0.30, 0.26};      ///< radiance from +Y, relative to intensity
    Color below = {0.25, 0.08, 0.06};      ///< radiance from -Y
    Color lamp = {1.0, 0.95, 0.9};         ///< colour of the soft lamp
    double lampStrength = 28.0;            ///< [-], >= 0, radiance in its middle
    double lampSize = 0.22;                ///< [rad], in [0.05, 3], angle at which it has fallen to 60 %
    Vec3 lampDirection = {0.3, 0.8, 0.52}; ///< [-], from the scene towards the lamp; any length but 0
    Color background = {0.0, 0.0, 0.0};    ///< colour of pixels without a body
};

constexpr auto fields(const EnvironmentDef*)
{
    using D = EnvironmentDef;
    return describe("EnvironmentDef", field("intensity", &D::intensity, "lx", nonNegative(), "illuminance of colour 1"),
                    field("above", &D::above, "radiance from +Y"), field("below", &D::below, "radiance from -Y"),
                    field("lamp", &D::lamp, "colour of the soft lamp"),
                    field("lampStrength", &D::lampStrength, "-", nonNegative(), "radiance in the lamp's middle"),
                    field("lampSize", &D::lampSize, "rad", closed(0.05, 3), "where it has fallen to 60 %"),
                    field("lampDirection", &D::lampDirection, "-", finite(), "from the scene towards the lamp"),
                    field("background", &D::background, "color of pixels without a body"));
}

} // namespace filasofia::visual
