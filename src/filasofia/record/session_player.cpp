#include "filasofia/record/session_player.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/replay.h"

namespace filasofia::record {

struct SessionPlayer::Impl {
    RecordingReader reader;
    std::unique_ptr<physics::PhysicsEngine> engine;
    Replayer replayer;
    physics::StepRecord recorded = {};
    physics::StepReport report = {};
    frame::Frame frame = {};
    bool captured = false;
    std::string damage = {};
    std::vector<physics::AddBody> bodies = {};

    Impl(const std::filesystem::path& file, const MakeEngine& makeEngine)
        : reader(file), engine(makeEngine(reader.header())), replayer(*engine)
    {
    }

    /// False at the end, and at damage.
    bool read()
    {
        if (!damage.empty()) return false;
        try {
            auto step = reader.next();
            reader.takeScene(); // not drawn here
            if (step) recorded = std::move(*step);
            return step.has_value();
        } catch (const Error& problem) {
            damage = problem.what();
            return false;
        }
    }
};

SessionPlayer::SessionPlayer(const std::filesystem::path& file, const MakeEngine& makeEngine)
    : impl_(std::make_unique<Impl>(file, makeEngine))
{
}
SessionPlayer::~SessionPlayer() = default;

const RecordingHeader& SessionPlayer::header() const { return impl_->reader.header(); }

bool SessionPlayer::next()
{
    if (!impl_->read()) return false;
    impl_->report = impl_->replayer.step(impl_->recorded);
    impl_->captured = false;
    for (const physics::Command& command : impl_->recorded.commands)
        if (const auto* add = std::get_if<physics::AddBody>(&command))
            impl_->bodies.push_back({add->id, add->def, nullptr, add->attachments});
    return true;
}

const physics::StepRecord& SessionPlayer::recorded() const { return impl_->recorded; }
const physics::StepReport& SessionPlayer::report() const { return impl_->report; }

const frame::Frame& SessionPlayer::frame()
{
    if (!std::exchange(impl_->captured, true)) impl_->engine->capture(impl_->frame);
    return impl_->frame;
}

bool SessionPlayer::same() const { return impl_->recorded.hash == 0 || impl_->engine->hash() == impl_->recorded.hash; }

const std::string& SessionPlayer::damage() const { return impl_->damage; }
const std::vector<physics::AddBody>& SessionPlayer::bodies() const { return impl_->bodies; }

} // namespace filasofia::record
