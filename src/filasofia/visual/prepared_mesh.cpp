#include "filasofia/visual/prepared_mesh.h"

#include "filasofia/core/text.h"
#include "filasofia/visual/scene.h"

namespace filasofia::visual {
namespace {

PreparedMesh::Impl prepare(geometry::TriangleMesh rest, int level, std::string_view name)
{
    checkPositions(rest.vertices, rest.vertices.size(), name);
    Subdivision subdivision(rest, level, text("body '", name, "'"));
    BodyGeometry geometry = bodyGeometry(subdivision, rest.vertices, rest.vertices);
    return {std::move(rest), std::move(subdivision), std::move(geometry)};
}

} // namespace

PreparedMesh::PreparedMesh(geometry::TriangleMesh rest, int subdivision, std::string_view name)
    : impl_(new Impl{prepare(std::move(rest), subdivision, name)})
{
}
PreparedMesh::~PreparedMesh() = default;
PreparedMesh::PreparedMesh(PreparedMesh&&) noexcept = default;
PreparedMesh& PreparedMesh::operator=(PreparedMesh&&) noexcept = default;
const geometry::TriangleMesh& PreparedMesh::rest() const { return impl_->rest; }

} // namespace filasofia::visual
