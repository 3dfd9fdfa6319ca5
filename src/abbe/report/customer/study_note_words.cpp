// Notes of studies: verdicts, doubts and warnings. The English formats are compared with the sources that make them.
#include "abbe/report/customer/customer_note_words.h"

namespace abbe {
namespace {

constexpr NoteWord kStudyNotes[] = {
    // Of the result before a correction, and of figures.
    {"before: not to be trusted: {w}",
     {"Vor der Korrektur: nicht vertrauenswürdig: {0}", "补偿前：结果不可信：{0}", "補正前：信頼できません：{0}"}},
    {"before: {}: {w}.", {"Vor der Korrektur: {0}: {1}.", "补偿前：{0}：{1}。", "補正前：{0}：{1}。"}},
    {"after: {}: {w}.", {"Nach der Korrektur: {0}: {1}.", "补偿后：{0}：{1}。", "補正後：{0}：{1}。"}},
    {"before: {w}.", {"Vor der Korrektur: {0}.", "补偿前：{0}。", "補正前：{0}。"}},
    // Verdicts.
    {"Accepted despite doubts ({}).",
     {"Trotz Zweifeln angenommen ({0}).", "虽有疑问仍予接受（{0}）。", "疑問があるが採用（{0}）。"}},
    {"Not to be trusted ({}).", {"Nicht vertrauenswürdig ({0}).", "结果不可信（{0}）。", "信頼できません（{0}）。"}},
    {"{} of the {} errors that move the tool are identified.",
     {"{0} der {1} Abweichungen, die das Werkzeug bewegen, sind ermittelt.",
      "在使刀具移动的 {1} 项误差中辨识了 {0} 项。", "工具を動かす {1} 個の誤差のうち {0} 個を同定しました。"}},
    {"Predicted volumetric error {} um before, {} um (k = 2) after correction, mean over {}.",
     {"Vorhergesagte volumetrische Abweichung {0} µm vor und {1} µm (k = 2) nach der Korrektur, Mittel über {2}.",
      "预测体积误差：补偿前 {0} µm，补偿后 {1} µm（k = 2），{2}的平均值。",
      "予測空間誤差：補正前 {0} µm、補正後 {1} µm（k = 2）、{2}の平均。"}},
    {"Predicted volumetric error {} um before, {} um (k = 2, {}) after correction, mean over {}.",
     {"Vorhergesagte volumetrische Abweichung {0} µm vor und {1} µm (k = 2, {2}) nach der Korrektur, Mittel über {3}.",
      "预测体积误差：补偿前 {0} µm，补偿后 {1} µm（k = 2，{2}），{3}的平均值。",
      "予測空間誤差：補正前 {0} µm、補正後 {1} µm（k = 2、{2}）、{3}の平均。"}},
    {"Predicted volumetric error {} um before, mean over {}.",
     {"Vorhergesagte volumetrische Abweichung {0} µm vor der Korrektur, Mittel über {1}.",
      "预测体积误差：补偿前 {0} µm，{1}的平均值。", "予測空間誤差：補正前 {0} µm、{1}の平均。"}},
    {"True volumetric error {} um before, {} um after correction (predicted: {} um, k = 2), mean over {}.",
     {"Wahre volumetrische Abweichung {0} µm vor und {1} µm nach der Korrektur (vorhergesagt: {2} µm, k = 2), Mittel "
      "über {3}.",
      "真实体积误差：补偿前 {0} µm，补偿后 {1} µm（预测：{2} µm，k = 2），{3}的平均值。",
      "真の空間誤差：補正前 {0} µm、補正後 {1} µm（予測：{2} µm、k = 2）、{3}の平均。"}},
    {"True volumetric error {} um before, {} um after correction (predicted: {} um, k = 2, {}), mean over {}.",
     {"Wahre volumetrische Abweichung {0} µm vor und {1} µm nach der Korrektur (vorhergesagt: {2} µm, k = 2, {3}), "
      "Mittel über {4}.",
      "真实体积误差：补偿前 {0} µm，补偿后 {1} µm（预测：{2} µm，k = 2，{3}），{4}的平均值。",
      "真の空間誤差：補正前 {0} µm、補正後 {1} µm（予測：{2} µm、k = 2、{3}）、{4}の平均。"}},
    {"True volumetric error {} um before, {} um after correction, mean over {}.",
     {"Wahre volumetrische Abweichung {0} µm vor und {1} µm nach der Korrektur, Mittel über {2}.",
      "真实体积误差：补偿前 {0} µm，补偿后 {1} µm，{2}的平均值。",
      "真の空間誤差：補正前 {0} µm、補正後 {1} µm、{2}の平均。"}},
    {"Identified; no pose has a volumetric error.",
     {"Ermittelt; für keine Pose gibt es eine volumetrische Abweichung.", "已辨识；没有任何位姿具有体积误差。",
      "同定済み。空間誤差をもつ姿勢はありません。"}},
    {"Residual of the readings: {} times their stated uncertainties.",
     {"Residuen der Messwerte: das {0}-Fache ihrer angegebenen Unsicherheiten.", "读数残差：为所给不确定度的 {0} 倍。",
      "測定値の残差：記載された不確かさの {0} 倍。"}},
    {"Residual of the readings: {} times their stated uncertainties without the {} outlier, {} times with it.",
     {"Residuen der Messwerte: ohne den {1} Ausreißer das {0}-Fache ihrer angegebenen Unsicherheiten, mit ihm das "
      "{2}-Fache.",
      "读数残差：不含 {1} 个异常值时为所给不确定度的 {0} 倍，含之为 {2} 倍。",
      "測定値の残差：{1} 個の外れ値を除き記載された不確かさの {0} 倍、含めると {2} 倍。"}},
    {"Residual of the readings: {} times their stated uncertainties without the {} outliers, {} times with them.",
     {"Residuen der Messwerte: ohne die {1} Ausreißer das {0}-Fache ihrer angegebenen Unsicherheiten, mit ihnen das "
      "{2}-Fache.",
      "读数残差：不含 {1} 个异常值时为所给不确定度的 {0} 倍，含之为 {2} 倍。",
      "測定値の残差：{1} 個の外れ値を除き記載された不確かさの {0} 倍、含めると {2} 倍。"}},
    // States.
    {"The figures hold at the state {}.",
     {"Die Werte gelten im Zustand {0}.", "各数值适用于状态 {0}。", "各値は状態 {0} におけるものです。"}},
    {"The readings cover {}; beyond, errors are extrapolated: their uncertainty grows with the distance, and nothing "
     "is "
     "proven.",
     {"Die Messwerte decken {0} ab; außerhalb sind die Abweichungen extrapoliert: Ihre Unsicherheit wächst mit dem "
      "Abstand, und nichts ist nachgewiesen.",
      "读数覆盖 {0}；超出此范围的误差为外推值：不确定度随距离增大，且未得到任何证明。",
      "測定値の範囲は {0} です。これを超えると誤差は外挿となり、不確かさは距離とともに増大し、何も証明されません。"}},
    {"Outside the states that the readings cover: {}.",
     {"Außerhalb der von den Messwerten abgedeckten Zustände: {0}.", "超出读数所覆盖的状态：{0}。",
      "測定値の範囲外の状態：{0}。"}},
    {"States that follow from the commands are in the volumetric error; the other figures hold where the factors of "
     "these errors are zero: {}.",
     {"Zustände, die aus den Sollwerten folgen, sind in der volumetrischen Abweichung enthalten; die übrigen Werte "
      "gelten dort, wo die Faktoren dieser Abweichungen null sind: {0}.",
      "由指令得出的状态已计入体积误差；其余数值适用于以下误差的因子为零之处：{0}。",
      "指令から定まる状態は空間誤差に含まれます。他の値は次の誤差の係数が零となる所で成り立ちます：{0}。"}},
    // What is not identified, and what the readings leave open.
    {"Not identified and taken as zero: {}.",
     {"Nicht ermittelt und als null angenommen: {0}.", "未辨识、按零处理：{0}。", "同定せず零とみなしたもの：{0}。"}},
    {"not identified: {}.", {"Nicht ermittelt: {0}.", "未辨识：{0}。", "同定していないもの：{0}。"}},
    {"They are taken as zero; the uncertainty of the volumetric error does not cover them.",
     {"Sie gelten als null; die Unsicherheit der volumetrischen Abweichung deckt sie nicht ab.",
      "它们按零处理；体积误差的不确定度未涵盖它们。", "これらは零とみなし、空間誤差の不確かさには含まれません。"}},
    {"The true ones are zero in this simulation, those of usual size ({} um, {} urad each) would make about {} um.",
     {"In dieser Simulation sind die wahren null; solche üblicher Größe (je {0} µm, {1} µrad) würden etwa {2} µm "
      "ergeben.",
      "在此仿真中其真值为零；通常大小（各 {0} µm、{1} µrad）时约产生 {2} µm。",
      "このシミュレーションでは真値は零です。通常の大きさ（各 {0} µm、{1} µrad）では約 {2} µm になります。"}},
    {"The true ones make {} um of it (root mean square), those of usual size ({} um, {} urad each) would make about "
     "{} um.",
     {"Die wahren machen {0} µm davon aus (quadratisches Mittel); solche üblicher Größe (je {1} µm, {2} µrad) würden "
      "etwa {3} µm ergeben.",
      "其真值占 {0} µm（均方根）；通常大小（各 {1} µm、{2} µrad）时约产生 {3} µm。",
      "真値によるものは {0} µm（二乗平均平方根）です。通常の大きさ（各 {1} µm、{2} µrad）では約 {3} µm になります。"}},
    {"Errors of usual size ({} um, {} urad each) there make about {} um.",
     {"Abweichungen üblicher Größe (je {0} µm, {1} µrad) ergeben dort etwa {2} µm.",
      "通常大小的误差（各 {0} µm、{1} µrad）约产生 {2} µm。",
      "通常の大きさの誤差（各 {0} µm、{1} µrad）では約 {2} µm になります。"}},
    {"the readings leave the volumetric error open in {} direction, beyond the choice of the workpiece datum; what is "
     "assumed there decides it: {}.",
     {"Die Messwerte lassen die volumetrische Abweichung in {0} Richtung offen, abgesehen von der Wahl des "
      "Werkstückbezugs; was dort angenommen ist, entscheidet: {1}.",
      "除工件基准的选择外，读数使体积误差在 {0} 个方向上未定；由该处的假定决定：{1}。",
      "工作物の基準の選び方を除き、測定値では空間誤差が {0} 方向で定まりません。次の仮定によります：{1}。"}},
    {"the readings leave the volumetric error open in {} directions, beyond the choice of the workpiece datum; what is "
     "assumed there decides it: {}.",
     {"Die Messwerte lassen die volumetrische Abweichung in {0} Richtungen offen, abgesehen von der Wahl des "
      "Werkstückbezugs; was dort angenommen ist, entscheidet: {1}.",
      "除工件基准的选择外，读数使体积误差在 {0} 个方向上未定；由该处的假定决定：{1}。",
      "工作物の基準の選び方を除き、測定値では空間誤差が {0} 方向で定まりません。次の仮定によります：{1}。"}},
    {"{} um (root mean square) of the volumetric error lie there.",
     {"{0} µm (quadratisches Mittel) der volumetrischen Abweichung liegen dort.", "其中体积误差占 {0} µm（均方根）。",
      "空間誤差のうち {0} µm（二乗平均平方根）がそこにあります。"}},
    {"Predicted uncertainties do not include it.",
     {"Vorhergesagte Unsicherheiten enthalten sie nicht.", "预测不确定度不包含它。",
      "予測した不確かさには含まれません。"}},
    // Doubts.
    {"Not to be trusted: {w}.", {"Nicht vertrauenswürdig: {0}.", "结果不可信：{0}。", "信頼できません：{0}。"}},
    {"the residuals are {} times as large as the stated uncertainties of the readings explain (chi-square probability "
     "{}): the model lacks errors that the readings show, or the readings are less certain than stated.",
     {"Die Residuen sind {0}-mal so groß, wie es die angegebenen Unsicherheiten der Messwerte erklären "
      "(Chi-Quadrat-Wahrscheinlichkeit {1}): Dem Modell fehlen Abweichungen, die die Messwerte zeigen, oder die "
      "Messwerte sind unsicherer als angegeben.",
      "残差为读数所给不确定度所能解释的 {0} 倍（卡方概率 {1}）：模型缺少读数所显示的误差，或读数的不确定度大于所给值。",
      "残差は記載された測定値の不確かさで説明できる大きさの {0} 倍です（カイ二乗の確率 "
      "{1}）：測定値に現れた誤差がモデルにないか、測定値が記載より不確かです。"}},
    {"The stated uncertainties of the result are too small.",
     {"Die angegebenen Unsicherheiten des Ergebnisses sind zu klein.", "结果所给的不确定度偏小。",
      "結果に記載された不確かさは小さすぎます。"}},
    {"the residuals are only {} times as large as the stated uncertainties of the readings (chi-square {} with {} "
     "degrees of freedom, probability above 1 - {}): the readings are more certain than stated, or they are not "
     "independent, such as duplicate rows.",
     {"Die Residuen sind nur {0}-mal so groß wie die angegebenen Unsicherheiten der Messwerte (Chi-Quadrat {1} mit {2} "
      "Freiheitsgraden, Wahrscheinlichkeit über 1 − {3}): Die Messwerte sind sicherer als angegeben, oder sie sind "
      "nicht unabhängig, etwa doppelte Zeilen.",
      "残差仅为读数所给不确定度的 {0} 倍（卡方 {1}，自由度 {2}，概率高于 1 − "
      "{3}）：读数的不确定度小于所给值，或读数不独立，例如有重复行。",
      "残差は記載された測定値の不確かさの {0} 倍しかありません（カイ二乗 {1}、自由度 {2}、確率 1 − {3} "
      "超）：測定値が記載より確かであるか、重複行などのため独立ではありません。"}},
    {"The stated uncertainties of the result do not fit them.",
     {"Die angegebenen Unsicherheiten des Ergebnisses passen nicht dazu.", "结果所给的不确定度与之不符。",
      "結果に記載された不確かさはこれに合いません。"}},
    {"outliers are clustered: {} (by chance with a probability of {}).",
     {"Ausreißer liegen beieinander: {0} (zufällig mit einer Wahrscheinlichkeit von {1}).",
      "异常值聚集：{0}（偶然出现的概率为 {1}）。", "外れ値が集まっています：{0}（偶然である確率 {1}）。"}},
    {"outliers are clustered: {} (by chance with a probability below {}).",
     {"Ausreißer liegen beieinander: {0} (zufällig mit einer Wahrscheinlichkeit unter {1}).",
      "异常值聚集：{0}（偶然出现的概率低于 {1}）。", "外れ値が集まっています：{0}（偶然である確率 {1} 未満）。"}},
    {"Something was different there, or the model does not hold.",
     {"Dort war etwas anders, oder das Modell gilt nicht.", "该处情况有所不同，或模型不成立。",
      "そこでは何かが異なったか、モデルが成り立ちません。"}},
    {"set-up {}: {} of {} pairs of readings at the same pose agree to the last digit, first rows {} and {}; by the "
     "stated uncertainty about {} would.",
     {"Aufbau {0}: {1} von {2} Paaren von Messwerten an derselben Pose stimmen bis zur letzten Stelle überein, zuerst "
      "die Zeilen {3} und {4}; nach der angegebenen Unsicherheit wären es etwa {5}.",
      "安装 {0}：同一位姿的 {2} 对读数中有 {1} 对完全相同，首先是第 {3} 行和第 {4} 行；按所给不确定度约为 {5} 对。",
      "設置 {0}：同じ姿勢の測定値 {2} 組のうち {1} 組が最後の桁まで一致します（最初は {3} 行目と {4} "
      "行目）。記載された不確かさからは約 {5} 組です。"}},
    {"These are duplicate rows, or one reading used for several.",
     {"Das sind doppelte Zeilen, oder ein Messwert steht für mehrere.", "它们是重复行，或将一个读数用作多个读数。",
      "重複行であるか、一つの測定値を複数に用いています。"}},
    {"They count as independent, so that the stated uncertainties of the result are too small.",
     {"Sie zählen als unabhängig, sodass die angegebenen Unsicherheiten des Ergebnisses zu klein sind.",
      "它们被视为独立，因此结果所给的不确定度偏小。", "独立とみなすため、結果に記載された不確かさは小さすぎます。"}},
    // Poses without a result.
    {"{} of {} poses of the map lies outside the range in which the errors are known; it is left out",
     {"{0} von {1} Posen der Karte liegt außerhalb des Bereichs, in dem die Abweichungen bekannt sind, und ist "
      "weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个位于误差已知的范围之外，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は誤差が既知の範囲の外にあり、除外しました"}},
    {"{} of {} poses of the map lie outside the range in which the errors are known; they are left out",
     {"{0} von {1} Posen der Karte liegen außerhalb des Bereichs, in dem die Abweichungen bekannt sind, und sind "
      "weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个位于误差已知的范围之外，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は誤差が既知の範囲の外にあり、除外しました"}},
    {"{} of {} poses of the map needs corrected commands outside the travel; it is left out",
     {"{0} von {1} Posen der Karte braucht korrigierte Befehle außerhalb des Verfahrwegs und ist weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个的补偿指令超出行程，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は補正指令が移動範囲を超え、除外しました"}},
    {"{} of {} poses of the map need corrected commands outside the travel; they are left out",
     {"{0} von {1} Posen der Karte brauchen korrigierte Befehle außerhalb des Verfahrwegs und sind weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个的补偿指令超出行程，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は補正指令が移動範囲を超え、除外しました"}},
    {"{} of {} poses of the map cannot be reached with the axes that are corrected; it is left out",
     {"{0} von {1} Posen der Karte ist mit den korrigierten Achsen nicht zu erreichen und ist weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个用参与补偿的轴无法到达，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は補正する軸では到達できず、除外しました"}},
    {"{} of {} poses of the map cannot be reached with the axes that are corrected; they are left out",
     {"{0} von {1} Posen der Karte sind mit den korrigierten Achsen nicht zu erreichen und sind weggelassen",
      "误差图的 {1} 个位姿中有 {0} 个用参与补偿的轴无法到达，未计入",
      "誤差マップの {1} 姿勢のうち {0} 姿勢は補正する軸では到達できず、除外しました"}},
    {"{} of {} poses of the map are left out: {}",
     {"{0} von {1} Posen der Karte sind weggelassen: {2}", "误差图的 {1} 个位姿中有 {0} 个未计入：{2}",
      "誤差マップの {1} 姿勢のうち {0} 姿勢を除外しました：{2}"}},
    // A figure without a value.
    {"{}: {w}.", {"{0}: {1}.", "{0}：{1}。", "{0}：{1}。"}},
};

}  // namespace

std::span<const NoteWord> study_note_words() { return kStudyNotes; }

}  // namespace abbe
