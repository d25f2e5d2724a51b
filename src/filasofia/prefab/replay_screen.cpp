#include "filasofia/prefab/replay_screen.h"

#include "filasofia/core/text.h"
#include "filasofia/prefab/plain_window.h"
#include "filasofia/prefab/task.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

namespace filasofia::prefab {
namespace {

using metric::EventKind;

constexpr double kPathRate = 50.0;  ///< [1/s], points of a path
constexpr double kTrail = 1.5;      ///< [s], how much is drawn before and after
constexpr double kShaft = 60e-3;    ///< [m], how much is drawn along an expert's tool
constexpr double kKeySeconds = 1.0; ///< [s] by which the arrow keys go
constexpr std::array kSpeeds = {0.25, 0.5, 1.0, 2.0, 4.0};

struct PathPoint {
    double time = 0.0; ///< [s]
    Vec3 tip = {};
    Vec3 back = {}; ///< [-], along the tool, away from its tip
};
using Path = std::vector<PathPoint>;

std::vector<Path> toolPaths(const metric::Session& session)
{
    std::vector<Path> out;
    for (const metric::Track& track : session.tracks) {
        if (track.role != metric::Role::Tool) continue;
        Path& path = out.emplace_back();
        for (const metric::Sample& sample : track.samples)
            if (isFinite(sample.pose) && (path.empty() || sample.time >= path.back().time + 1.0 / kPathRate))
                path.push_back({sample.time, sample.pose.position, -rotate(sample.pose.orientation, track.axis)});
    }
    return out;
}

std::vector<double> stepEnds(const metric::Session& session)
{
    std::vector<double> out;
    for (const metric::Event& event : session.events)
        if (event.kind == EventKind::Step) out.push_back(event.time);
    return out;
}

std::optional<double> endOf(const metric::Session& session, const std::string& step)
{
    for (const metric::Event& event : session.events)
        if (event.kind == EventKind::Step && event.what == step) return event.time;
    return std::nullopt;
}

/// Pairs of moments, the first and the second ascending.
using Moments = std::vector<std::pair<double, double>>;

Moments sameMoments(const metric::Session& own, const metric::Session& other)
{
    Moments out = {{0.0, 0.0}};
    for (const metric::Event& event : own.events) {
        if (event.kind != EventKind::Step) continue;
        const auto end = endOf(other, event.what);
        if (end && event.time > out.back().first && *end > out.back().second) out.emplace_back(event.time, *end);
    }
    return out;
}

double momentAt(const Moments& moments, double time)
{
    for (std::size_t i = 1; i < moments.size(); ++i) {
        const auto& [from, to] = std::pair{moments[i - 1], moments[i]};
        if (time < to.first)
            return from.second + (time - from.first) * (to.second - from.second) / (to.first - from.first);
    }
    return moments.back().second + time - moments.back().first;
}

/// Draws a path around a time, and its place then. Returns that place.
std::optional<PathPoint> drawPath(visual::DebugDraw& debug, const Path& path, double from, double now, double to,
                                  visual::Color color)
{
    const auto at = std::ranges::upper_bound(path, now, {}, &PathPoint::time);
    if (at == path.begin()) return std::nullopt;
    const auto begin = std::ranges::lower_bound(path, from, {}, &PathPoint::time);
    const auto end = std::ranges::upper_bound(path, to, {}, &PathPoint::time);
    for (auto each = begin; each != end && std::next(each) != end; ++each)
        debug.line(each->tip, std::next(each)->tip, {.color = color, .width = each < at ? 2.5 : 1.0, .onTop = true});
    return *std::prev(at);
}

} // namespace

double sameMoment(const metric::Session& own, const metric::Session& other, double time)
{
    return momentAt(sameMoments(own, other), time);
}

struct ReplayScreen::Impl {
    Impl(runtime::Simulation& simulation, const runtime::RewindDef& kept) : rewind(simulation, kept) {}

    /// The thread that delivers events.
    void press(const event::KeyEvent& key)
    {
        using event::KeyCode;
        if (!key.pressed || !open) return;
        if (key.key == KeyCode::Space && !key.repeat) ++toggles;
        if (key.key == KeyCode::Left) --seeks;
        if (key.key == KeyCode::Right) ++seeks;
        if (key.key == KeyCode::Escape) leaving = true;
    }

    void draw()
    {
        if (!open) return;
        const double begin = rewind.begin(), end = rewind.end();
        double time = std::clamp(now.load(), begin, end);
        if (toggles.exchange(0) % 2 == 1) toggle(time);
        if (const int by = seeks.exchange(0); by != 0) time = std::clamp(time + by * kKeySeconds, begin, end);
        if (playing) time = std::min(time + speed * double(ImGui::GetIO().DeltaTime), end);
        if (time >= end) playing = false;
        drawBar(begin, end, time);
        now = time;
        rewind.show(time);
        drawPaths(time);
        if (leaving.exchange(false)) close();
    }
    void toggle(double& time)
    {
        playing = !playing;
        if (playing && time >= rewind.end()) time = rewind.begin(); // once more
    }
    void close()
    {
        open = false;
        playing = false;
        rewind.showNewest();
        if (closed) closed();
    }

    void drawBar(double begin, double end, double& time)
    {
        const ImVec2 screen = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({0.5F * screen.x, screen.y - 8.0F}, ImGuiCond_Always, {0.5F, 1.0F});
        ImGui::SetNextWindowSize({screen.x - 16.0F, 0.0F});
        ImGui::SetNextWindowBgAlpha(1.0F); // what else is down there shows the present
        constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                           ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize;
        if (ImGui::Begin("replay", nullptr, flags)) {
            if (ImGui::Button(playing ? "Pause##play" : "Play##play", {4.5F * ImGui::GetFontSize(), 0.0F}))
                toggle(time);
            ImGui::SameLine();
            ImGui::SetNextItemWidth(-1.0F);
            auto at = static_cast<float>(time);
            if (ImGui::SliderFloat("##time", &at, float(begin), float(end), "%.1f s", ImGuiSliderFlags_AlwaysClamp)) {
                time = std::clamp(double(at), begin, end);
                playing = false;
            }
            drawStepEnds(begin, end);
            for (const double each : kSpeeds) {
                if (ImGui::RadioButton(text(each, "x").c_str(), speed == each)) speed = each;
                ImGui::SameLine();
            }
            if (!expert.empty()) {
                ImGui::Checkbox("Expert", &expertShown);
                ImGui::SameLine();
            }
            if (ImGui::Button("Back")) leaving = true;
            if (!said.empty()) {
                ImGui::SameLine();
                line(shown(said, 80));
            }
        }
        ImGui::End();
    }
    /// On the slider that was drawn last.
    void drawStepEnds(double begin, double end) const
    {
        if (!(end > begin)) return;
        const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
        for (const double each : ends) {
            const float x = from.x + static_cast<float>((each - begin) / (end - begin)) * (to.x - from.x);
            if (x < from.x || x > to.x) continue;
            ImGui::GetWindowDrawList()->AddLine({x, from.y}, {x, to.y}, IM_COL32(90, 220, 120, 200), 2.0F);
        }
    }

    void drawPaths(double time)
    {
        if (server == nullptr) return;
        visual::DebugDraw& debug = server->debug();
        for (const Path& path : own) drawPath(debug, path, time - kTrail, time, time, {0.15, 0.45, 1.0});
        if (!expertShown) return;
        const visual::Color green{0.2, 0.9, 0.4};
        const double then = momentAt(moments, time);
        for (const Path& path : expert)
            if (const auto tool = drawPath(debug, path, then - kTrail, then, then + kTrail, green)) {
                debug.point(tool->tip, {.color = green, .width = 10.0, .onTop = true});
                debug.line(tool->tip, tool->tip + kShaft * tool->back, {.color = green, .width = 3.0, .onTop = true});
            }
    }

    /// Says which moments belong together, as far as both sessions are known.
    void join()
    {
        if (ownSteps && expertSteps) moments = sameMoments(*ownSteps, *expertSteps);
    }

    runtime::Rewind rewind;
    visual::VisualServer* server = nullptr;
    std::function<void()> closed;
    std::vector<Path> own, expert;
    std::vector<double> ends;                             ///< [s], when steps were done
    std::optional<metric::Session> ownSteps, expertSteps; ///< without samples
    Moments moments = {{0.0, 0.0}};
    std::string said;
    double speed = 1.0;
    bool playing = false, expertShown = true;
    std::atomic<bool> open = false, leaving = false;
    std::atomic<int> toggles = 0, seeks = 0; ///< keys that were pressed since the last picture
    std::atomic<double> now = 0.0;           ///< [s]
};

ReplayScreen::ReplayScreen(runtime::Simulation& simulation, const runtime::RewindDef& kept)
    : impl_(std::make_shared<Impl>(simulation, kept))
{
    const auto weak = std::weak_ptr(impl_);
    simulation.on<event::KeyEvent>([weak](const event::KeyEvent& key) {
        if (const auto impl = weak.lock()) impl->press(key);
    });
    simulation.show(visual::GuiDef{.name = "replay", .renderCallback = [weak] {
                                       if (const auto impl = weak.lock()) impl->draw();
                                   }});
}

void ReplayScreen::dress(visual::VisualServer& server) { impl_->server = &server; }

void ReplayScreen::open(std::function<void()> closed)
{
    Impl& it = *impl_;
    it.closed = std::move(closed);
    it.now = it.rewind.begin();
    it.toggles = 0;
    it.seeks = 0;
    it.leaving = false;
    it.playing = true;
    it.open = true;
}

void ReplayScreen::setOwn(const metric::Session& session)
{
    impl_->own = toolPaths(session);
    impl_->ends = stepEnds(session);
    impl_->ownSteps = metric::Session{.events = session.events};
    impl_->join();
}

void ReplayScreen::setExpert(const metric::Session& session)
{
    impl_->expert = toolPaths(session);
    impl_->expertSteps = metric::Session{.events = session.events};
    impl_->join();
}

void ReplayScreen::say(std::string line) { impl_->said = std::move(line); }
bool ReplayScreen::isOpen() const { return impl_->open; }
double ReplayScreen::shownAt() const { return impl_->now; }

} // namespace filasofia::prefab
