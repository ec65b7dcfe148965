// Levels of detail of a store: tells its reader what the panes and the scene show, and gives them
// what comes.
#pragma once

#include <QElapsedTimer>
#include <QObject>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>

#include "apps/viewer/model/detail.hpp"
#include "apps/viewer/scene/navigation.hpp"
#include "apps/viewer/window/desk.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

class DetailController : public Controller {
    Q_OBJECT

  public:
    explicit DetailController(const Desk& desk);
    ~DetailController() override;

    /// Looks at what is shown; as often as it is drawn.
    void observe(const std::optional<Snapshot>& now);
    /// Nothing finer is on its way, or it cannot be had.
    bool settled() const;
    /// True for a store.
    bool active() const { return reader_ != nullptr; }

    struct State {
        stream::DetailStatus reading;
        int felt = 0;  ///< level of the store
        /// The overview's level, and the finest that a picture shows; nothing: single samples of
        /// the coarsest.
        std::optional<int> overview, finest;
    };
    State state() const;

  private:
    static constexpr int scene = DetailMaker::scene;

    void begin();
    void end();
    std::optional<int> level_of_slice(const std::optional<SeenBox>& seen) const;
    bool has(int axis, const std::optional<SeenBox>& seen) const;
    void observe_slice(int axis);
    void want(int viewer, const std::optional<stream::DetailBox>& box,
              std::chrono::milliseconds interval);
    void observe_scene(const std::optional<Snapshot>& now);
    void choose_patch(const std::optional<Snapshot>& now);
    bool is_in_patch(const Snapshot& now) const;
    void take(std::uint64_t generation, int viewer, const std::shared_ptr<const DetailField>& made);

    SeenStore store_;
    Interpolation interpolation_ = Interpolation::linear;
    std::uint64_t generation_ = 0;  // of readers
    std::array<std::optional<stream::DetailBox>, DetailMaker::viewers> wanted_;
    std::optional<PatchChoice> patch_;  // that is wanted for the scene
    /// A view of the scene for which a patch was chosen.
    struct SceneView {
        pictures::Camera camera;
        int width = 0, height = 0;
        double level = 0;

        bool operator==(const SceneView&) const = default;
    };
    SceneView view_now() const;
    std::optional<SceneView> view_, chosen_for_;
    QElapsedTimer rested_;  // since the view is this one
    std::array<std::shared_ptr<const DetailField>, DetailMaker::viewers> made_;
    std::uint64_t memory_ = 0;                   // [bytes] of decoded pieces
    std::shared_ptr<const stream::Store> held_;  // store_ points into it
    std::atomic<int> handed_over_ = 0;           // by the maker, not taken yet
    std::shared_ptr<DetailMaker> maker_;
    std::unique_ptr<stream::DetailReader> reader_;
};

}  // namespace palpate::viewer
