#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <memory>
#include <string_view>

namespace filasofia::visual {

/// New triangles of a body, prepared for drawing without a server: the expensive part of a change of topology, on any
/// thread. VisualBody::adopt() does the rest.
class PreparedMesh {
public:
    /// `rest` [m] is the surface at rest, to which the pattern is fixed; `subdivision` in [0, 3]. Throws an Error
    /// naming `name` if the surface is wrong or cannot be subdivided.
    PreparedMesh(geometry::TriangleMesh rest, int subdivision, std::string_view name);
    ~PreparedMesh();
    PreparedMesh(PreparedMesh&&) noexcept;
    PreparedMesh& operator=(PreparedMesh&&) noexcept;

    [[nodiscard]] const geometry::TriangleMesh& rest() const;

    struct Impl;
    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
