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
    SharedSurface from; ///< the surface that is replaced
    SharedSurface to;   ///< the surface that replaces it; null: built from `opening` on `boundary`
    int subdivision = 0;
    std::string name = {}; ///< the body's name
    std::shared_ptr<const mapping::OpeningSurface> opening = {};
    std::shared_ptr<const frame::Boundary> boundary = {};
};

/// The worker's result, ready for the main thread.
struct MeshResult {
    SharedSurface surface;
    visual::PreparedMesh mesh;
    int subdivision = 0;
    std::vector<mapping::SurfaceTransfer> transfers; ///< from the surface adopted last, one after another
};

/// Computes the expensive part of new triangles; a pure function. If a surface cannot be subdivided (a cut may leave
/// two parts that share only an edge), it is drawn without subdivision and a warning is logged.
MeshResult prepareMesh(const MeshJob& job);

/// Prepares meshes on a thread of its own, which starts with the first job. For each surface one job is at work, and
/// only the newest of the others waits. Results are handed out even if a newer job waits; otherwise edits at every step
/// would never be seen. Any thread asks, one takes.
class MeshWorker {
public:
    using Prepare = std::function<MeshResult(const MeshJob&)>;
    explicit MeshWorker(Prepare prepare = prepareMesh) : prepare_(std::move(prepare)) {}
    ~MeshWorker();
    MeshWorker(const MeshWorker&) = delete;
    MeshWorker& operator=(const MeshWorker&) = delete;

    /// `job.from` is the surface drawn now. If newer ones are under way, the worker replaces it by the newest.
    void ask(SurfaceKey key, MeshJob job);
    /// The newest result that was not taken yet, if `fits` accepts its surface.
    std::optional<MeshResult> take(SurfaceKey key, const std::function<bool(const mapping::MappedSurface&)>& fits);
    /// Waits until all jobs are done.
    void finish();
    /// Drops the waiting job, the one at work and the result.
    void forget(SurfaceKey key);

private:
    struct Surface {
        std::optional<MeshJob> waiting = {};
        bool working = false;
        bool forgotten = false;    ///< forget() was called while a job was at work
        SharedSurface newest = {}; ///< the newest prepared surface, from which the next job starts
        std::optional<MeshResult> done = {};
    };
    void work();
    void put(Surface& surface, MeshResult result);
    [[nodiscard]] std::map<SurfaceKey, Surface>::iterator nextJob();

    Prepare prepare_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<SurfaceKey, Surface> surfaces_;
    SurfaceKey served_ = 0; ///< the surface served last
    bool stop_ = false;
    std::thread thread_;
};

} // namespace filasofia::runtime
