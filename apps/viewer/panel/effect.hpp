// The settings that panel, menus and keys show and change.
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <optional>

#include "palpate/run/statistics.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// Whoever shows a setting reads it here, and whoever changes one asks here. Nobody keeps a copy,
/// so nothing has to be undone after a refusal. GUI thread only.
class Effect : public QObject {
    Q_OBJECT

  public:
    /// Carries out a command, or throws a std::exception, which says why not.
    using CarryOut = std::function<void(const Command&)>;

    /// Another session. Without `carry_out` a recording is played: nothing can be changed.
    void begin(const Field& field, double isovalue, const RendererSettings& settings,
               const DeviceInfo& device, const run::Histogram& histogram, CarryOut carry_out);
    void end();
    /// The command is carried out, or refused with a reason: then nothing has changed. Without a
    /// session nothing happens.
    bool request(const Command& command);
    /// What holds by now, if it is newer than what was asked for. About thirty times a second.
    void observe(const Snapshot& snapshot);

    /// Nothing is felt or played without one.
    bool there() const { return session_.has_value(); }
    bool is_played() const { return there() && !carry_out_; }
    /// The usual ones without a session.
    const RendererSettings& settings() const {
        static const RendererSettings usual;
        return there() ? session_->renderer.settings : usual;
    }
    // Of a session that is there:
    /// As it began, with all commands since. Its field has no edits.
    const Session& session() const { return *session_; }
    /// The level that was asked for last.
    double isovalue() const { return session_->renderer.proxy.isovalue; }
    const Field& field() const { return session_->renderer.field; }
    const run::Histogram& histogram() const { return histogram_; }
    const DeviceInfo& device() const { return device_; }

  Q_SIGNALS:
    void begun();
    void ended();
    /// Show what is in effect: a session has begun, or a request was answered.
    void changed();
    /// `why`: it was refused; empty: it was carried out.
    void answered(const palpate::Command& command, const QString& why);
    void observed(const palpate::Snapshot& snapshot);

  private:
    QString refusal_of(const Command& command);

    std::optional<Session> session_;
    run::Histogram histogram_;
    DeviceInfo device_;
    CarryOut carry_out_;
    int awaited_ = 0;  // so many snapshots may still differ from what was asked for
};

}  // namespace palpate::viewer
