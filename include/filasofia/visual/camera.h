#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/visual/transform.h"

#include <memory>
#include <numbers>

namespace filasofia::visual {

/// Looks along -Z of its pose; +Y is up in the picture.
struct CameraDef {
    std::string name = "camera";
    double verticalFieldOfView = 60.0 * std::numbers::pi / 180.0; ///< [rad], in [0.01, 3]
    double near = 0.005;                                          ///< [m], > 0
    double far = 2.0;                                             ///< [m], > near
    double exposure = 11.0;     ///< [EV at ISO 100], in [-10, 25]; larger values make the picture darker
    double focusDistance = 0.1; ///< [m], > 0, distance that is sharp (DepthOfField)
    /// [-], in [0.5, 64], f-number of a lens with a picture 24 mm high; a smaller one blurs more.
    double aperture = 8.0;
};

constexpr auto fields(const CameraDef*)
{
    using D = CameraDef;
    return describe("CameraDef", field("name", &D::name, "name in errors"),
                    field("verticalFieldOfView", &D::verticalFieldOfView, "rad", closed(0.01, 3), "full angle"),
                    field("near", &D::near, "m", positive(), "nothing nearer is drawn"),
                    field("far", &D::far, "m", positive(), "nothing farther is drawn"),
                    field("exposure", &D::exposure, "EV at ISO 100", closed(-10, 25), "larger is darker"),
                    field("focusDistance", &D::focusDistance, "m", positive(), "distance that is sharp"),
                    field("aperture", &D::aperture, "-", closed(0.5, 64), "f-number; a smaller one blurs more"));
}

/// A camera; made by VisualServer::add, drawn where a View shows it. Main thread only.
class Camera final : public Transform {
public:
    struct Impl;
    Camera(std::string name, std::unique_ptr<Impl> impl);
    ~Camera() override;

    [[nodiscard]] const CameraDef& def() const;
    /// Throws an Error naming the camera and the field that is out of range.
    void set(const CameraDef& def);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
