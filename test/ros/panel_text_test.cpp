// SPDX-License-Identifier: BSD-3-Clause
// Names and messages that look like HTML are shown as they are. Qt would open the files that they name: a FIFO for
// ever.
#include "ros/panel/plain_text.h"

#include <string>

#include <QApplication>
#include <QTextDocument>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ros/panel/actuator_editor.h"

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

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  setenv("QT_QPA_PLATFORM", "offscreen", 1);
  testing::InitGoogleTest(&argc, argv);
  const QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
