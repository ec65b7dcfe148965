// The form for an address, and what was found there.
#include "apps/viewer/window/store_dialog.hpp"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSpinBox>

#include "apps/options/exit_status.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/scene/hand_over.hpp"
#include "apps/viewer/window/streaming_words.hpp"

namespace palpate::viewer {
namespace {

QString product(const Index3& size) {
    return QString("%1 x %2 x %3").arg(size[0]).arg(size[1]).arg(size[2]);
}

QString product(const Vec3& spacing) {
    const auto number = [](double mm) { return QString::number(mm, 'g', 4); };
    return number(spacing[0]) + " x " + number(spacing[1]) + " x " + number(spacing[2]);
}

/// Of a request, while somebody waits before a dialog.
constexpr int most_attempts = 2;
constexpr double timeout_s = 5;

}  // namespace

/// Written by the thread that looks.
struct StoreDialog::Found {
    stream::StoreInfo info;
    run::StoreSource source;
    QString problem;
};

QString level_words(const stream::StoreInfo& info, int level) {
    const Geometry& grid = info.levels[static_cast<std::size_t>(level)].geometry;
    const double bytes = double(sample_count(grid)) * double(size_of(info.type));
    return StoreDialog::tr("%1: %2 samples, every %3 %4, %5")
        .arg(QString::number(level), product(grid.size), product(grid.spacing),
             QString(unit_word(grid)), bytes_text(bytes));
}

StoreDialog::StoreDialog(const std::optional<run::StoreSource>& known, int time, QWidget* parent)
    : QDialog(parent),
      address_(named(new QLineEdit, "store_address")),
      look_(named(new QPushButton(tr("Look it up")), "store_look",
                  tr("Reads which levels, channels and times there are"))),
      level_(named(new QComboBox, "store_level")),
      channel_(named(new QComboBox, "store_channel")),
      time_(named(new QSpinBox, "store_time")),
      all_times_(named(new QCheckBox(tr("All, as a sequence")), "store_all_times",
                       tr("Plays them; each is read whole at this level"))),
      forbidden_(named(new QCheckBox(tr("Status 403 means: not stored")), "store_forbidden",
                       tr("S3 answers so for missing pieces where the list is not public"))),
      verdict_(named(new QLabel, "store_verdict")),
      first_time_(time) {
    setObjectName("store");
    setWindowTitle(known ? tr("Level, channel and time") : tr("Open an address"));
    auto* form = new QFormLayout;
    address_->setPlaceholderText("https://…/image.zarr");
    address_->setMinimumWidth(60 * fontMetrics().averageCharWidth());
    add_row(*form, tr("Address"), row_of({address_, look_}, 0),
            tr("http, https or s3, or the folder or file of a volume that is read in parts"));
    add_row(*form, tr("Level"), level_,
            tr("The level of detail that is felt, and the finest that is seen; 0 is the finest"));
    add_row(*form, tr("Channel"), channel_, tr("Of an image with several"));
    add_row(*form, tr("Time"), row_of({time_, all_times_}, 0),
            tr("The moment of an image with several, from 0"));
    add_row(*form, tr("Missing pieces"), forbidden_,
            tr("What a server answers for pieces that hold only the fill value"));
    form->addRow(verdict_);
    verdict_->setWordWrap(true);
    verdict_->setTextFormat(Qt::PlainText);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel);
    accept_ = buttons->button(QDialogButtonBox::Open);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    auto* fields = new QWidget;
    fields->setLayout(form);
    column_in(this, {fields, buttons})->setContentsMargins(9, 9, 9, 9);
    connect(all_times_, &QCheckBox::toggled, time_, &QWidget::setDisabled);
    connect(look_, &QPushButton::clicked, this, &StoreDialog::look);
    connect(address_, &QLineEdit::returnPressed, this, &StoreDialog::look);
    // Return in the line looks; it must not open what was found at another address.
    for (auto* button : findChildren<QPushButton*>()) button->setAutoDefault(false);
    connect(address_, &QLineEdit::textEdited, this, [this] {
        worker_.cancel();
        looking_ = found_ = nullptr;
        show_found();
    });
    if (known) {
        known_ = *known;
        first_level_ = known->loader.level;
        first_channel_ = known->options.channel;
        all_times_->setChecked(known->all_times);
        forbidden_->setChecked(known->options.forbidden_is_missing);
        address_->setText(QString::fromStdString(known->address));
        address_->setReadOnly(true);
        look();
    }
    show_found();
}

StoreDialog::~StoreDialog() = default;

void StoreDialog::look() {
    const std::string address = address_->text().trimmed().toStdString();
    if (address.empty()) return;
    const auto found = std::make_shared<Found>();
    found->source = known_;
    looking_ = found;
    found_.reset();
    show_found();
    verdict_->setText(tr("Looking …"));
    worker_.start(
        [found, address, is_known = address == known_.address](const io::Progress& progress) {
            try {
                if (!is_known) {
                    // As a session keeps names: "level" says that it is a store.
                    const run::Source source =
                        run::source_from({{"volume", address}, {"level", "0"}});
                    found->source = std::get<run::StoreSource>(source.from);
                }
                stream::StoreOptions options = found->source.options;
                options.attempts = most_attempts;
                options.timeout_s = timeout_s;
                found->info = stream::open_store(address, options, progress)->info();
            } catch (const std::exception& e) {
                found->problem = QString::fromStdString(app::failure_of(e).text);
            }
        },
        [this, found] { hand_over(this, [this, found] { take(found); }); });
}

/// Unless another address was asked for since.
void StoreDialog::take(const std::shared_ptr<Found>& found) {
    if (found != looking_ || !worker_.ended()) return;
    if (found->problem.isEmpty()) found_ = found;
    show_found();
    if (!found->problem.isEmpty()) verdict_->setText(found->problem);
}

void StoreDialog::show_found() {
    const bool good = found_ != nullptr;
    level_->clear();
    channel_->clear();
    verdict_->clear();
    for (QWidget* field : std::initializer_list<QWidget*>{level_, channel_, time_, all_times_}) {
        field->setEnabled(good);
    }
    accept_->setEnabled(good);
    if (!good) return;
    const stream::StoreInfo& info = found_->info;
    for (int i = 0; i < static_cast<int>(info.levels.size()); ++i) {
        level_->addItem(level_words(info, i));
    }
    level_->setCurrentIndex(std::min(first_level_, level_->count() - 1));
    for (std::size_t i = 0; i < info.channels.size(); ++i) {
        const QString name = QString::fromStdString(info.channels[i]);
        channel_->addItem(name.isEmpty() ? QString::number(i) : QString("%1: %2").arg(i).arg(name));
    }
    channel_->setCurrentIndex(std::min(first_channel_, channel_->count() - 1));
    channel_->setEnabled(channel_->count() > 1);
    time_->setRange(0, std::max(0, info.times - 1));
    time_->setValue(first_time_);
    all_times_->setEnabled(info.times > 1);
    time_->setEnabled(info.times > 1 && !all_times_->isChecked());
    verdict_->setText(QString::fromStdString(info.format));
    accept_->setFocus();
}

run::Source StoreDialog::source() const {
    run::StoreSource store = found_ ? found_->source : known_;
    store.loader.level = std::max(0, level_->currentIndex());
    store.options.channel = std::max(0, channel_->currentIndex());
    store.options.forbidden_is_missing = forbidden_->isChecked();
    store.all_times = time_->maximum() > 0 && all_times_->isChecked();
    // They are for what is read as it is felt.
    if (store.all_times) store.loader.whole_process = store.loader.coarse_first = false;
    run::Source source;
    source.from = std::move(store);
    if (time_->maximum() > 0 && !store.all_times) source.frame = time_->value();
    return source;
}

}  // namespace palpate::viewer
