#pragma once

#include "filasofia/visual/canvas.h"
#include "filasofia/visual/debug_draw.h"
#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/gui.h"
#include "filasofia/visual/image.h"
#include "filasofia/visual/light.h"
#include "filasofia/visual/smoke.h"
#include "filasofia/visual/view.h"
#include "filasofia/visual/visual_body.h"

#include <functional>
#include <map>

namespace filasofia::visual {

/// Where the pictures go.
enum class Backend {
    Window,   ///< into an X11 window
    Headless, ///< into memory; needs neither a screen nor an X server
    Null,     ///< nothing is drawn, all else works; for tests without a GPU
};
constexpr std::array<std::string_view, 3> names(const Backend*) { return {"window", "headless", "null"}; }

struct VisualServerDef {
    Backend backend = Backend::Headless;
    int width = 960;              ///< [px], in [1, 8192]
    int height = 720;             ///< [px], in [1, 8192]
    void* nativeWindow = nullptr; ///< the X11 Window id, for Backend::Window; not a field of files
};

constexpr auto fields(const VisualServerDef*)
{
    using D = VisualServerDef;
    return describe("VisualServerDef", field("backend", &D::backend, "where the pictures go"),
                    field("width", &D::width, "px", closed(1, 8192), "size of the window"),
                    field("height", &D::height, "px", closed(1, 8192), "size of the window"));
}

/// Time that the main thread's work on the picture has taken, by the clock given to timeStages(); zeros without a
/// clock.
struct VisualStages {
    double subdivision = 0.0; ///< [s], checking positions, converting them to float, and subdividing
    double normals = 0.0;     ///< [s], normals and tangent frames
    double upload = 0.0;      ///< [s], passing vertices to the graphics library
    double submit = 0.0;      ///< [s], poses and drawing; with the software renderer headless, the drawing itself
};

/// Statistics since the server was made.
struct VisualStatistics {
    long framesDrawn = 0;
    long framesSkipped = 0;        ///< frames that the graphics library asked to skip
    long vertexUpdates = 0;        ///< shapes sent to the graphics library, including the first of each body
    double lastFrameSeconds = 0.0; ///< [s], wall time of the last drawn frame
    double lastGuiSeconds = 0.0;   ///< [s], part of it for renderCallbacks and debug drawings
    int bodies = 0;
    int lights = 0;
    int cameras = 0;
    int views = 0;
    VisualStages stages = {};
};

/// Whether this build can draw with the backend (Null: always).
[[nodiscard]] bool hasBackend(Backend backend);

/// Owns the scene and draws it. All of it belongs to the thread that made it (asserted).
///
/// The objects returned by add() stay valid until they are removed or the server ends.
class VisualServer {
public:
    /// Throws an Error if a field is out of range, the backend is not in this build, or it cannot start (no display, no
    /// OpenGL 4.1).
    explicit VisualServer(const VisualServerDef& def = {});
    ~VisualServer();
    VisualServer(const VisualServer&) = delete;
    VisualServer& operator=(const VisualServer&) = delete;

    /// Throw an Error naming the object, the field and the bound if the Def is wrong.
    VisualBody& add(const VisualBodyDef& def);
    Light& add(const LightDef& def);
    Camera& add(const CameraDef& def);
    View& add(const ViewDef& def, Camera& camera);
    Gui& add(const GuiDef& def, View& view);
    Gui& add(const GuiDef& def); ///< over the whole window
    Canvas& add(const CanvasDef& def);
    /// A transform without content, as a parent for others: a rig.
    Transform& addTransform(std::string name);

    /// Its children keep their world pose. Throws an Error if it does not belong to this server, or is a camera that a
    /// view shows.
    void remove(Transform& entity);
    void remove(View& view); ///< Error if a Gui lies on it
    void remove(Gui& gui);

    /// Passes input to the Guis, the upper ones first. Returns true if one of them took it, so that nothing else should
    /// act on it.
    bool handle(const event::Event& event);
    /// Whether somebody writes into a field of a Gui; pass it to window::Window::setTextInput().
    [[nodiscard]] bool wantsText() const;
    /// Scales text and spacing of all Guis to the screen's resolution (window::Window::scale). Throws an Error if it is
    /// outside [0.5, 8].
    void setGuiScale(double scale);
    /// The entities, in the order in which they were added.
    [[nodiscard]] std::vector<VisualBody*> bodies() const;
    [[nodiscard]] std::vector<View*> views() const;
    [[nodiscard]] std::vector<Light*> lights() const;
    [[nodiscard]] std::vector<Camera*> cameras() const;
    [[nodiscard]] const EnvironmentDef& environment() const;
    /// The pool's materials, by name.
    [[nodiscard]] const std::map<std::string, Material>& materials() const;

    /// Lines, points and texts in the scene.
    [[nodiscard]] DebugDraw& debug();

    /// Adds a material that bodies can share as NamedMaterial{name}. Throws an Error if the name is already used, or
    /// the material is itself a NamedMaterial or wrong in any way.
    void addMaterial(const std::string& name, const Material& material);
    /// Changes a material, and with it every body that uses it. Throws an Error like addMaterial() and
    /// VisualBody::setMaterial(); then nothing has changed.
    void changeMaterial(const std::string& name, const Material& material);
    /// Throws an Error if there is no such material, or a body uses it.
    void removeMaterial(const std::string& name);
    /// Throws an Error if there is no such material.
    [[nodiscard]] const Material& material(const std::string& name) const;

    /// Replaces the surroundings (there is a default from the start). Throws an Error like add().
    void setEnvironment(const EnvironmentDef& def);

    /// Replaces the smoke in the air of all views. Throws an Error if a number is out of range.
    void setSmoke(const Smoke& smoke);

    /// Draws one frame. Returns false if the graphics library asks to skip it.
    bool render();

    /// Sets the size in pixels, in [1, 8192]; otherwise throws an Error.
    void resize(int width, int height);
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;

    /// Draws the present scene and returns the picture. The same scene gives the same picture, bit for bit. With the
    /// null backend the picture is black. Throws an Error if the graphics library gives none.
    Image capture();

    /// What the window shows of bodies: the depth and label of each pixel, through endoscope optics if the view has
    /// them. Transparent bodies count like others; lines, Guis, Canvases and the surroundings do not. The same scene
    /// gives the same numbers. With the null backend nothing is seen.
    DepthImage captureDepth();

    [[nodiscard]] VisualStatistics statistics() const;
    /// From now on VisualStatistics::stages has the times of the stages by this clock [s]; an empty one costs nothing.
    void timeStages(std::function<double()> now);

    /// Whether `entity` belongs to this server: a body, light, camera or rig. It may have been destroyed.
    [[nodiscard]] bool has(const Transform& entity) const;

    struct Impl;
    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
