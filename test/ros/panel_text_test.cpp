// SPDX-License-Identifier: BSD-3-Clause
// Names and messages that look like HTML are shown as they are. Qt would open the files that they name: a FIFO for
// ever. And what is drawn of numbers.
#include "ros/panel/plain_text.h"

#include <string>
#include <utility>

#include <QApplication>
#include <QComboBox>
#include <QImage>
#include <QKeyEvent>
#include <QTextDocument>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ros/panel/actuator_editor.h"
#include "ros/panel/number_box.h"
#include "ros/panel/plot_view.h"
#include "ros/view/label_picture.h"

namespace soft_robot_lab {
namespace {

class PanelText : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(mkfifo(fifo_.c_str(), 0600), 0); }
  void TearDown() override { unlink(fifo_.c_str()); }

  const std::string fifo_ = testing::TempDir() + "panel_text_" + std::to_string(getpid());
  const std::string html_ = "<img src='" + fifo_ + "'>";
};

TEST_F(PanelText, LabelsOfAnActuatorAreDrawnAsTheyAreWritten) {
  ActuatorRow row;
  row.name = row.unit = row.measured = html_;
  row.max = 1.0;
  row.step = 0.01;
  row.decimals = 3;
  ActuatorEditor editor(
      row, 1, [](double) {}, nullptr);
  editor.show_row(row);
  for (const QLabel* label : editor.findChildren<QLabel*>()) EXPECT_EQ(label->textFormat(), Qt::PlainText);
  EXPECT_FALSE(editor.grab().isNull());
  editor.close();
}

TEST_F(PanelText, HintsAndLampsHoldNoHtmlOfOthers) {
  const Lamp lamp{"Link", Lamp::Level::error, html_, "two\nlines " + html_};
  for (const QString& text : {plain_hint(QString::fromStdString(html_)), lamp_text(lamp), lamp_reasons({lamp, lamp})}) {
    EXPECT_TRUE(Qt::mightBeRichText(text)) << "what Qt takes for plain it may take for HTML next time";
    EXPECT_FALSE(text.contains("<img")) << text.toStdString();
    EXPECT_TRUE(text.contains("&lt;img"));
  }
}

// A target within or behind the robot: its ring, the dashes to it and their length lie over whatever is drawn there.
TEST(LabelPicture, ShowsTheTargetThroughTheSkinWithItsDistance) {
  const QSize window(400, 300);
  const Eigen::Vector2d from(120, 150), to(280, 150);
  CoveredCells skin({400, 300});
  skin.add_triangle({-400, -300}, {1200, -300}, {0, 900});  // all of the window
  LabelPicture picture;
  picture.aims = {{from, to}};
  const auto painted = [&] { return LabelPainter().paint(picture, skin, window, QFont()); };
  const QImage unlabelled = painted();
  int red = 0, pale = 0;  // dashes, and what is between them
  for (int x = 140; x < 260; ++x) {
    const QColor seen = unlabelled.pixelColor(x, 150);
    EXPECT_GT(seen.alpha(), 150) << "the skin would hide it at " << x;
    (seen.green() < 90 ? red : pale) += 1;
  }
  EXPECT_GT(red, 30);
  EXPECT_GT(pale, 10);
  const QColor ring = unlabelled.pixelColor(280, 140);
  EXPECT_GT(ring.alpha(), 240);
  EXPECT_GT(ring.red(), ring.blue() + 100) << "orange";
  picture.texts = {{"error", "12.34 mm", 0.5 * (from + to), true}};
  const QImage labelled = painted();
  EXPECT_NE(labelled, unlabelled);
  picture.texts[0].text = "43.21 mm";
  EXPECT_NE(painted(), labelled);
}

// Of the colour of what is filled, left and right of rest.
std::pair<int, int> filled_beside_rest(double shown) {
  RestSlider slider(nullptr);
  slider.setRange(0, 80);
  slider.set_rest(30);
  slider.setValue(static_cast<int>(80 * shown));
  slider.resize(300, 30);
  const QImage image = slider.grab().toImage();
  const QColor wanted = slider.palette().highlight().color();
  const int rest_px = image.width() * 30 / 80, y = image.height() / 2;
  std::pair<int, int> filled;
  for (int x = 0; x < image.width(); ++x)
    if (image.pixelColor(x, y) == wanted) ++(x < rest_px ? filled.first : filled.second);
  return filled;
}

TEST(PanelSlider, IsFilledFromRestToWhereItStands) {
  const auto [less_left, less_right] = filled_beside_rest(0.1);
  const auto [more_left, more_right] = filled_beside_rest(0.8);
  EXPECT_GT(less_left, 50);
  EXPECT_LT(less_right, 5);
  EXPECT_LT(more_left, 5);
  EXPECT_GT(more_right, 100);
  const auto [none_left, none_right] = filled_beside_rest(30.0 / 80.0);
  EXPECT_LT(none_left + none_right, 5);
}

// Qt takes a comma for a separator of thousands where the locale's point is one, and the other way round in others.
TEST(PanelNumber, TakesACommaForAPointInEveryLocale) {
  for (const QLocale::Language language : {QLocale::C, QLocale::English, QLocale::German}) {
    QLocale::setDefault(language == QLocale::C ? QLocale::c() : QLocale(language));
    for (const auto& [typed, shown] :
         {std::pair("12,5", "x 12.5"), std::pair("12.5", "x 12.5"), std::pair("1,2,5", "x 1.2"),
          std::pair("-0,5", "x -0.5"), std::pair("1234,5", "x 1234.5")}) {
      NumberBox box(nullptr);
      box.setDecimals(1);
      box.setRange(-9999.0, 9999.0);
      box.setPrefix("x ");
      box.selectAll();
      for (const char* key = typed; *key; ++key) {
        const QString text(*key);
        QKeyEvent press(QEvent::KeyPress, 0, Qt::NoModifier, text);
        QApplication::sendEvent(&box, &press);
      }
      box.interpretText();
      EXPECT_EQ(box.text(), shown) << typed << " in " << QLocale::languageToString(language).toStdString();
    }
  }
  QLocale::setDefault(QLocale::c());
}

TEST(PanelPlot, KeepsWhatWasChosenThoughAnotherRobotBeginsWithout) {
  History history;
  MarkerObservations markers;
  markers.names = {"tip"};
  markers.positions.resize(1);
  ActuatorState state;
  state.cables.resize(1);
  history.add(markers, "tip");
  history.add(state);
  PlotView plot(nullptr);
  plot.show();
  plot.show_history(history);
  auto* title = plot.findChild<QComboBox*>();
  ASSERT_EQ(title->count(), 2);
  EXPECT_EQ(title->currentText(), "tension [N]");
  title->setCurrentText("tip [mm]");
  Q_EMIT title->textActivated("tip [mm]");
  History next;
  next.add(state);
  plot.show_history(next);
  EXPECT_EQ(title->currentText(), "tension [N]") << "there is nothing else yet";
  next.add(markers, "tip");
  plot.show_history(next);
  EXPECT_EQ(title->currentText(), "tip [mm]");
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  setenv("QT_QPA_PLATFORM", "offscreen", 1);
  testing::InitGoogleTest(&argc, argv);
  const QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
