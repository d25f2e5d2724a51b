#pragma once

#include "filasofia/mapping/opening_surface.h"
#include "filasofia/mapping/transfer.h"
#include "filasofia/runtime/painted_surfaces.h"
#include "filasofia/visual/prepared_mesh.h"

#include <condition_variable>
#include <functional>
#include <thread>

namespace filasofia::runtime {

/// New triangles for a surface that is drawn.
struct MeshJob {
    SharedSurface from; ///< the surface that it takes the place of
    SharedSurface to;   ///< none: `opening` on `boundary`
    int subdivision = 0;
    std::string name = {}; ///< of the body
    std::shared_ptr<const mapping::OpeningSurface> opening = {};
    std::shared_ptr<const frame::Boundary> boundary = {};
};

/// What a worker made of it, ready for the main thread.
struct MeshResult {
    SharedSurface surface;
    visual::PreparedMesh mesh;
    int subdivision = 0;
    std::vector<mapping::SurfaceTransfer> transfers; ///< from the surface adopted last, one after another
};

/// The long part of new triangles: a pure function. A surface that cannot be subdivided (a cut may leave two parts that
/// hang together by an edge only) is drawn as it is; that is logged.
MeshResult prepareMesh(const MeshJob& job);

/// Prepares meshes on a thread of its own, which starts with the first. Per surface one job is at work and one, the
/// newest, waits. What is done is handed out even where a newer one waits: edits at every step would otherwise never be
/// seen. Any thread asks, one takes.
class MeshWorker {
public:
    using Prepare = std::function<MeshResult(const MeshJob&)>;
    explicit MeshWorker(Prepare prepare = prepareMesh) : prepare_(std::move(prepare)) {}
    ~MeshWorker();
    MeshWorker(const MeshWorker&) = delete;
    MeshWorker& operator=(const MeshWorker&) = delete;

    /// `job.from` is the surface now drawn; where newer ones are under way, the worker knows better.
    void ask(SurfaceKey key, MeshJob job);
    /// The newest that is done and was not taken yet, if `fits` takes its surface.
    std::optional<MeshResult> take(SurfaceKey key, const std::function<bool(const mapping::MappedSurface&)>& fits);
    /// Waits until all that was asked is done.
    void finish();
    /// Drops what was asked, is at work and is done.
    void forget(SurfaceKey key);

private:
    struct Surface {
        std::optional<MeshJob> waiting = {};
        bool working = false;
        bool forgotten = false;    ///< while it was at work
        SharedSurface newest = {}; ///< that was prepared: the next one comes from there
        std::optional<MeshResult> done = {};
    };
    void work();
    void put(Surface& surface, MeshResult result);
    [[nodiscard]] std::map<SurfaceKey, Surface>::iterator nextJob();

    Prepare prepare_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<SurfaceKey, Surface> surfaces_;
    SurfaceKey served_ = 0; ///< last
    bool stop_ = false;
    std::thread thread_;
};

} // namespace filasofia::runtime
