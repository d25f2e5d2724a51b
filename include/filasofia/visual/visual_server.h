#pragma once

#include "filasofia/visual/canvas.h"
#include "filasofia/visual/debug_draw.h"
#include "filasofia/visual/gui.h"
#include "filasofia/visual/image.h"
#include "filasofia/visual/light.h"
#include "filasofia/visual/view.h"
#include "filasofia/visual/visual_body.h"

#include <functional>
#include <map>

namespace filasofia::visual {

/// Where the pictures go.
enum class Backend {
    Window,   ///< into an X11 window
    Headless, ///< into memory; needs neither a screen nor an X server
    Null,     ///< nowhere: nothing is drawn, all else works; for tests without a GPU
};

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
                    field("width", &D::width, "px", closed(1, 8192), "of the window"),
                    field("height", &D::height, "px", closed(1, 8192), "of the window"));
}

/// What the main thread's work on the picture took so far, by the clock given to timeStages(); zeros without one.
struct VisualStages {
    double subdivision = 0.0; ///< [s], checking positions, turning them to floats, and the refined ones
    double normals = 0.0;     ///< [s], normals and tangent frames
    double upload = 0.0;      ///< [s], handing vertices to the graphics library
    double submit = 0.0;      ///< [s], poses, and drawing; with the software renderer headless, the drawing itself
};

/// How it went so far.
struct VisualStatistics {
    long framesDrawn = 0;
    long framesSkipped = 0;        ///< frames that the graphics library asked to leave out
    long vertexUpdates = 0;        ///< shapes sent to the graphics library, the first of each body included
    double lastFrameSeconds = 0.0; ///< [s], wall time of the last frame drawn
    double lastGuiSeconds = 0.0;   ///< [s], of these: renderCallbacks and debug drawings
    int bodies = 0;
    int lights = 0;
    int cameras = 0;
    int views = 0;
    VisualStages stages = {};
};

/// Whether this build can draw with the backend (Null: always).
[[nodiscard]] bool hasBackend(Backend backend);

/// Owns the scene and draws it. Everything about it belongs to the thread that made it (asserted).
///
/// What add() returns stays valid until it is removed or the server ends.
class VisualServer {
public:
    /// Throws an Error when a field is out of range, the backend is not in this build, or it cannot start (no display,
    /// no OpenGL 4.1).
    explicit VisualServer(const VisualServerDef& def = {});
    ~VisualServer();
    VisualServer(const VisualServer&) = delete;
    VisualServer& operator=(const VisualServer&) = delete;

    /// Throw an Error naming the object, the field and the bound when something is wrong with the Def.
    VisualBody& add(const VisualBodyDef& def);
    Light& add(const LightDef& def);
    Camera& add(const CameraDef& def);
    View& add(const ViewDef& def, Camera& camera);
    Gui& add(const GuiDef& def, View& view);
    Gui& add(const GuiDef& def); ///< over the whole window
    Canvas& add(const CanvasDef& def);
    /// A place without content, to hang others on: a rig.
    Transform& addTransform(std::string name);

    /// Its children keep their world pose. Throws an Error when it is not of this server, or a camera that a view
    /// shows.
    void remove(Transform& entity);
    void remove(View& view); ///< Error where a Gui lies on it
    void remove(Gui& gui);

    /// Shows what a person did to the Guis, the upper ones first. True: one of them takes it, and nothing else should
    /// act on it.
    bool handle(const event::Event& event);
    /// Somebody writes into a field of a Gui: what window::Window::setTextInput() is told.
    [[nodiscard]] bool wantsText() const;
    /// Scales the texts and spaces of all Guis, as the screen's resolution asks (window::Window::scale). Throws an
    /// Error where it is out of [0.5, 8].
    void setGuiScale(double scale);
    /// What there is, in the order in which it was added.
    [[nodiscard]] std::vector<VisualBody*> bodies() const;
    [[nodiscard]] std::vector<View*> views() const;
    [[nodiscard]] std::vector<Light*> lights() const;
    [[nodiscard]] std::vector<Camera*> cameras() const;
    [[nodiscard]] const EnvironmentDef& environment() const;
    /// The pool's materials, by name.
    [[nodiscard]] const std::map<std::string, Material>& materials() const;

    /// Lines, points and texts in the scene.
    [[nodiscard]] DebugDraw& debug();

    /// A material that bodies can share: NamedMaterial{name}. Throws an Error when there is one of this name already,
    /// it is itself a NamedMaterial, or anything about it is wrong.
    void addMaterial(const std::string& name, const Material& material);
    /// Changes it, and every body that uses it. Throws an Error as addMaterial() and VisualBody::setMaterial() do; then
    /// nothing has changed.
    void changeMaterial(const std::string& name, const Material& material);
    /// Throws an Error when there is none of this name, or a body uses it.
    void removeMaterial(const std::string& name);
    /// Throws an Error when there is none of this name.
    [[nodiscard]] const Material& material(const std::string& name) const;

    /// Replaces the surroundings (a default is there from the start). Throws an Error as add() does.
    void setEnvironment(const EnvironmentDef& def);

    /// Draws one frame; false when the graphics library asks to skip it.
    bool render();

    /// Pixels from now on, in [1, 8192]; otherwise throws an Error.
    void resize(int width, int height);
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;

    /// Draws the scene as it is now and reads the picture back. The same scene gives the same picture, bit for bit.
    /// With the null backend the picture is black. Throws an Error when the graphics library gives none.
    Image capture();

    [[nodiscard]] VisualStatistics statistics() const;
    /// From now on VisualStatistics::stages tells what the stages take by this clock [s]; an empty one costs nothing.
    void timeStages(std::function<double()> now);

    /// Whether `entity` is one of this server's: bodies, lights, cameras and rigs. It may have ended.
    [[nodiscard]] bool has(const Transform& entity) const;

    struct Impl;
    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
