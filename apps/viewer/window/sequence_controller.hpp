// Plays the sequence that is felt: connects the sequence bar with the player of the live run.
#pragma once

#include <QObject>
#include <QString>

namespace palpate::viewer {

class Content;
class Messages;
class SequenceBar;

class SequenceController : public QObject {
    Q_OBJECT

  public:
    SequenceController(Content& content, SequenceBar& bar, Messages& messages);

    /// Shows in the bar where the player is; tells of frames that are missing.
    void observe();

  private:
    void show();

    Content& content_;
    SequenceBar& bar_;
    Messages& messages_;
    QString problem_;
};

}  // namespace palpate::viewer
