#include "filasofia/runtime/run_files.h"

#include "filasofia/core/date.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"

#include <chrono>
#include <limits>

namespace filasofia::runtime {
namespace {

using namespace std::chrono_literals;

constexpr auto kLook = 5ms; // interval between looks at the log, which holds four times what 100 kHz make in that time
constexpr auto kFlush = 250ms;          // a killed program loses as much; a quarter of what we promise
constexpr std::uint64_t kBehind = 2048; // [steps], half of the log

} // namespace

RunFiles::RunFiles(Simulation::Impl& impl, const RunDef& def) : impl_(impl)
{
    if (!def.log.empty()) table_.emplace(def.log);
    if (!def.record.empty()) {
        const std::string name = impl.physics.engine().info().name;
        const bool ours = name == record::RecordingHeader{}.engine;
        recording_.emplace(def.record, record::RecordingHeader{.simd = ours ? engine::simdTargets().front() : "",
                                                               .engine = name,
                                                               .period = 1.0 / impl.def.physics.rate,
                                                               .contact = impl.def.physics.contact,
                                                               .seed = static_cast<std::uint64_t>(def.seed),
                                                               .session = def.session,
                                                               .trainee = def.trainee,
                                                               .date = dateNow()});
        impl.journal.watch();
        if (const visual::VisualServer* visual = impl.bindings.visual()) impl.journal.observe(*visual, 0);
        const window::WindowDef& window = impl.def.window;
        const SceneBegan began{impl.def.look, window.width, window.height, !impl.picture.dresses.empty()};
        attempt(recording_, [&](record::RecordingWriter& file) { file.write(recordOf(began)); });
    } else {
        impl.journal.close();
    }
    while (impl.physics.nextRecord()) impl.physics.popRecord(); // left by a run that failed
    const bool any = table_ || recording_;
    impl.physics.keepLog(any);
    impl.physics.hashEveryStep(any);
    if (!any) return;
    flush(); // so that even a program that is killed at once leaves a valid header
    thread_ = std::thread([this] { work(); });
}

RunFiles::~RunFiles() { close(); }

template <class File, class Write> void RunFiles::attempt(std::optional<File>& file, Write&& write)
{
    if (!file) return;
    try {
        write(*file);
    } catch (const std::exception& problem) {
        file.reset();
        logError(problem.what(), "; the run goes on without this file");
        impl_.files.addFileProblem(problem.what()); // read when the thread has ended
        auto event = std::make_unique<FileFailedEvent>();
        event->problem = problem.what();
        impl_.now.stamp(*event);
        if (!impl_.events.tryPost(std::move(event))) logWarning("the event queue is full: no event reports this");
    }
}

void RunFiles::work()
{
    auto flushed = std::chrono::steady_clock::now();
    for (bool last = false; !last;) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, kLook, [this] { return ending_ || made_ > written_.load() + kBehind; });
            last = ending_;
        }
        drain();
        caughtUp_.notify_all();
        const auto now = std::chrono::steady_clock::now();
        if (now - flushed < kFlush) continue;
        flushed = now;
        flush();
    }
    writeScene(std::numeric_limits<std::uint64_t>::max());
    attempt(table_, [](record::StepTable& file) { file.close(); });
    attempt(recording_, [](record::RecordingWriter& file) { file.close(); });
}

void RunFiles::drain()
{
    while (const physics::StepRecord* step = impl_.physics.nextRecord()) {
        write(*step);
        impl_.physics.popRecord();
        written_.fetch_add(1);
    }
}

void RunFiles::write(const physics::StepRecord& step)
{
    // A paused step has the number of the step before it, so an event between the two came after both.
    writeScene(step.report.step);
    attempt(table_, [&](record::StepTable& file) { file.write(step); });
    attempt(recording_, [&](record::RecordingWriter& file) { file.write(step); });
}

void RunFiles::writeScene(std::uint64_t beforeStep)
{
    while (auto event = impl_.journal.takeBefore(beforeStep))
        attempt(recording_, [&](record::RecordingWriter& file) {
            for (const std::string& name : filesOf(*event)) {
                const auto known = filesDescribed_.insert(name).second ? digested(name) : std::nullopt;
                if (known) file.write(recordOf(*known));
            }
            file.write(recordOf(*event));
        });
}

void RunFiles::flush()
{
    attempt(table_, [](record::StepTable& file) { file.flush(); });
    attempt(recording_, [](record::RecordingWriter& file) { file.flush(); });
}

void RunFiles::keepUp()
{
    if (!thread_.joinable()) return;
    if (made_.fetch_add(1) + 1 <= written_.load() + kBehind) return;
    std::unique_lock lock(mutex_);
    wake_.notify_one();
    caughtUp_.wait(lock, [this] { return made_ <= written_.load() + kBehind; });
}

void RunFiles::close()
{
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

} // namespace filasofia::runtime
