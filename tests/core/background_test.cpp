#include "filasofia/core/background.h"

#include <thread>
#include <vector>

namespace background_test {

using namespace filasofia;

TEST_CASE("a background job that nobody has begun is done by the thread that needs it")
{
    const auto here = std::this_thread::get_id();
    std::thread::id by;
    BackgroundJob job([&] { by = std::this_thread::get_id(); });
    job.finish();
    CHECK(by == here);
}

TEST_CASE("a background job is done once, whoever asks for it and however often")
{
    BackgroundThread thread;
    std::vector<int> done(200);
    std::vector<std::shared_ptr<BackgroundJob>> jobs;
    for (int& each : done) {
        jobs.push_back(std::make_shared<BackgroundJob>([&each] { ++each; }));
        thread.submit(jobs.back());
        if (jobs.size() % 3 == 0) jobs.back()->finish(); // races with the thread
    }
    for (const auto& job : jobs) job->finish();
    for (const auto& job : jobs) job->finish();
    CHECK(done == std::vector<int>(200, 1));
}

TEST_CASE("a background job that was dropped is not done, and a thread with jobs left ends")
{
    int done = 0;
    const auto dropped = std::make_shared<BackgroundJob>([&] { ++done; });
    dropped->drop();
    {
        BackgroundThread thread;
        thread.submit(dropped);
        for (int i = 0; i < 100; ++i) thread.submit(std::make_shared<BackgroundJob>([] {}));
    }
    dropped->finish();
    CHECK(done == 0);
}

} // namespace background_test
