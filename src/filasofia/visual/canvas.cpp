#include "filasofia/visual/canvas.h"

#include "filasofia/visual/overlays.h"

namespace filasofia::visual {

Canvas::Canvas(std::string name, std::unique_ptr<Impl> impl) : Transform(std::move(name)), impl_(std::move(impl)) {}
Canvas::~Canvas() = default;
const CanvasDef& Canvas::def() const { return impl_->def; }
void Canvas::setRenderCallback(RenderCallback callback) { impl_->surface.callback.set(std::move(callback)); }

} // namespace filasofia::visual
