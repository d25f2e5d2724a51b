#pragma once

#include "filasofia/core/text.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/record/chunks.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

/// What the tests of this room share: a run to record, and files that are removed afterwards.
namespace filasofia::record {

inline physics::SoftBodyDef bunny()
{
    return {.name = "bunny",
            .mesh = FILASOFIA_SOURCE_DIR "/assets/meshes/bunny_756.msh",
            .attachments = {{.box = geometry::Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

inline constexpr int kEventfulSteps = 30;

/// Thirty steps of a scene with every kind of command except tune(); `afterStep` is called after each.
template <class AfterStep> void eventfulRun(physics::PhysicsServer& server, AfterStep&& afterStep)
{
    server.keepLog(true);
    server.hashEveryStep(true);
    BodyId soft = server.add(bunny()), rigid = server.add(physics::RigidBodyDef{.name = "probe"});
    for (int step = 0; step < kEventfulSteps; ++step) {
        if (step == 3) server.setGravity({0, 0, -9.81});
        if (step == 5) server.setPose(rigid, {{0, 0.5, 0}, axisAngle({1, 2, 3}, 0.7)});
        if (step == 7) server.setMaterial(soft, physics::FemMaterial{.youngModulus = 20e3});
        if (step == 9) server.setForces(soft, {{.node = 3, .force = {0, 0.1, 0}}});
        if (step == 11) server.setPressure(soft, 50.0);
        if (step == 13) server.pause(true);
        if (step == 15) server.pause(false);
        if (step == 17) server.add(bunny());
        if (step == 20) server.reset();
        if (step == 25) server.remove(soft);
        server.step(step % 2 ? 1e-3 : 2e-3);
        afterStep();
    }
}

/// A file of this test's own, removed at its end.
class ScratchFile {
public:
    explicit ScratchFile(std::string_view name)
        : path_(std::filesystem::temp_directory_path() / text("filasofia_record_test_", getpid(), "_", name))
    {
    }
    ~ScratchFile() { std::filesystem::remove(path_); }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string name() const { return path_.string(); }
    void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
    [[nodiscard]] std::string bytes() const
    {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    [[nodiscard]] std::vector<std::string> lines() const { return linesOf(bytes()); }
    /// The content of a recording's chunks.
    [[nodiscard]] std::string content() const
    {
        ChunkReader chunks(name());
        std::string all;
        while (chunks.next(all)) {
        }
        return all;
    }
    /// The same, split into lines: the numbers of a mesh are the beginning of the line that follows them.
    [[nodiscard]] std::vector<std::string> records() const { return linesOf(content()); }

private:
    static std::vector<std::string> linesOf(const std::string& words)
    {
        std::istringstream in(words);
        std::vector<std::string> all;
        for (std::string line; std::getline(in, line);) all.push_back(line);
        return all;
    }

    std::filesystem::path path_;
};

/// A file whose chunks hold this content, `size` bytes each.
inline std::string framed(const std::string& content, std::size_t size = kMaximumChunk)
{
    std::string bytes = openingLine();
    std::uint32_t number = 0;
    for (std::size_t at = 0; at < content.size(); at += size) bytes += chunkOf(number++, content.substr(at, size));
    return bytes;
}

} // namespace filasofia::record
