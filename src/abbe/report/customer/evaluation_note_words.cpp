// Notes of evaluations. The tests of customer_notes.h compare the English formats with the sources that make the notes.
#include "abbe/report/customer/customer_note_words.h"

namespace abbe {
namespace {

constexpr NoteWord kEvaluationNotes[] = {
    // Corrections to 20 degrees Celsius.
    {"The deviations are corrected to 20 °C for the nominal differential expansion of machine and instrument (ISO "
     "230-2).",
     {"Die Abweichungen sind um die nominelle Differenzausdehnung von Maschine und Messgerät auf 20 °C korrigiert (ISO "
      "230-2).",
      "偏差已按机床与测量仪器的标称热膨胀差修正到 20 °C（ISO 230-2）。",
      "偏差は、機械と測定器の公称熱膨張差について 20 °C に補正してあります（ISO 230-2）。"}},
    {"The radii are corrected to 20 °C for the nominal differential expansion of machine and instrument (ISO 230-4).",
     {"Die Radien sind um die nominelle Differenzausdehnung von Maschine und Messgerät auf 20 °C korrigiert (ISO "
      "230-4).",
      "半径已按机床与测量仪器的标称热膨胀差修正到 20 °C（ISO 230-4）。",
      "半径は、機械と測定器の公称熱膨張差について 20 °C に補正してあります（ISO 230-4）。"}},
    {"No uncertainty of coefficients and temperatures was stated: the correction to 20 °C counts as exact.",
     {"Es sind keine Unsicherheiten der Ausdehnungskoeffizienten und Temperaturen angegeben: Die Korrektur auf 20 °C "
      "gilt als genau.",
      "未给出膨胀系数和温度的不确定度：到 20 °C 的修正视为准确。",
      "膨張係数及び温度の不確かさの記載がありません：20 °C への補正は正確とみなします。"}},
    // Circular tests.
    {"Some causes make the same pattern in these readings and cannot be separated: squareness and servo mismatch need "
     "both directions of a full circle, scales and centre need a full circle.",
     {"Einige Ursachen erzeugen bei diesen Messwerten dasselbe Muster und sind nicht zu unterscheiden: Beide "
      "Richtungen "
      "eines Vollkreises trennen Rechtwinkligkeit und Unterschied der Schleppabweichungen, ein Vollkreis trennt "
      "Maßstäbe und Mittelpunkt.",
      "部分原因在这些读数中产生相同的图形，无法区分：整圆的两个方向可区分垂直度与跟随误差之差，整圆可区分比例误差与圆"
      "心。",
      "一部の原因はこれらの測定値で同じ模様となり、区別できません：全円の両方向により直角度と追従誤差の差を、全円によ"
      "りスケール誤差と中心を区別できます。"}},
    {"Readings within {}° of a reversal of an axis are not used for the causes.",
     {"Messwerte im Bereich von {0}° um die Umkehr einer Achse gehen nicht in die Ursachen ein.",
      "轴线换向点 {0}° 以内的读数不参与原因分析。", "軸の反転点から {0}° 以内の測定値は原因の分析に用いません。"}},
    {"The residuals of the causes follow a pattern of their own: {} readings count as one in the uncertainties.",
     {"Was die Ursachen nicht erklären, folgt einem eigenen Muster: In ihren Unsicherheiten zählen {0} Messwerte als "
      "einer.",
      "这些原因未能解释的部分自成图形：在其不确定度中 {0} 个读数按一个计。",
      "原因で説明されない部分には固有の模様があり、不確かさにおいて {0} 個の測定値を 1 個として数えます。"}},
    {"The {} path is not a full circle, for which alone ISO 230-4 fits the centre.",
     {"Die Bahn {0} ist kein Vollkreis; nur bei einem solchen passt ISO 230-4 den Mittelpunkt ein.",
      "{0}轨迹不是整圆；ISO 230-4 仅对整圆拟合圆心。",
      "{0}の経路は全円ではありません。ISO 230-4 が中心を当てはめるのは全円の場合だけです。"}},
    {"No uncertainty of the instrument was stated (--u-reading-um): G, F and D have no measurement uncertainty.",
     {"Es ist keine Unsicherheit des Messgeräts angegeben (--u-reading-um): Für G, F und D gibt es keine "
      "Messunsicherheit.",
      "未给出仪器的不确定度（--u-reading-um）：G、F 和 D 没有测量不确定度。",
      "測定器の不確かさの記載がありません（--u-reading-um）：G、F 及び D には測定不確かさがありません。"}},
    {"Uncertainties of the causes are those of the fit (from its residuals); reversal values are as in ISO 230-2: "
     "approach in positive less approach in negative direction.",
     {"Die Unsicherheiten der Ursachen sind die der Ausgleichung (aus ihren Residuen); Umkehrspannen sind wie in ISO "
      "230-2: Anfahrt in positiver minus Anfahrt in negativer Richtung.",
      "各原因的不确定度为拟合的不确定度（由残差得出）；反向差值按 ISO 230-2：正向趋近减负向趋近。",
      "原因の不確かさは当てはめの不確かさ（残差による）です。反転値は ISO 230-2 "
      "によります：正の向きの位置決めから負の向きの位置決めを引いた値。"}},
    // Axes of rotation.
    {"No uncertainty of the displacement probes was stated (--u-reading-um): no measurement uncertainty is given.",
     {"Es ist keine Unsicherheit der Wegaufnehmer angegeben (--u-reading-um): Es wird keine Messunsicherheit "
      "angegeben.",
      "未给出位移传感器的不确定度（--u-reading-um）：不给出测量不确定度。",
      "変位計の不確かさの記載がありません（--u-reading-um）：測定不確かさは示しません。"}},
    {"The readings do not stand at the same angles in every turn; they were interpolated linearly in between.",
     {"Die Messwerte liegen nicht in jeder Umdrehung bei denselben Winkeln; dazwischen wurde linear interpoliert.",
      "各圈读数的角度不同；其间按线性插值。", "測定値の角度が回転ごとに異なるため、その間を直線補間しました。"}},
    {"{}: the mean of a turn drifts by {} {} from the first to the last turn; that is part of the asynchronous and "
     "total values.",
     {"{0}: Das Mittel einer Umdrehung wandert von der ersten bis zur letzten um {1} {2}; das ist Teil der "
      "asynchronen und der gesamten Werte.",
      "{0}：从第一圈到最后一圈，每圈平均值漂移 {1} {2}；它包含在异步值和总值中。",
      "{0}：1 回転の平均は最初から最後の回転までに {1} {2} 変化します。これは非同期値及び全値に含まれます。"}},
    {"The fundamental face error motion contains the angle between the measured face and the axis.",
     {"Die Grundbewegungsabweichung der Planseite enthält den Winkel zwischen gemessener Fläche und Achse.",
      "端面基波误差运动包含被测端面与轴线之间的夹角。",
      "端面の基本誤差運動には、測定した面と軸とのなす角が含まれます。"}},
    {"Roundness of the artefact is part of the synchronous values; it is not separated here.",
     {"Die Rundheit des Normals ist Teil der synchronen Werte; sie ist hier nicht abgetrennt.",
      "标准件的圆度包含在同步值中，此处未予分离。", "標準器の真円度は同期値に含まれ、ここでは分離していません。"}},
    // Lines.
    {"No uncertainty of the readings was stated (--u-reading-um): straightness has no measurement uncertainty.",
     {"Es ist keine Unsicherheit der Messwerte angegeben (--u-reading-um): Für die Geradheit gibt es keine "
      "Messunsicherheit.",
      "未给出读数的不确定度（--u-reading-um）：直线度没有测量不确定度。",
      "測定値の不確かさの記載がありません（--u-reading-um）：真直度には測定不確かさがありません。"}},
    {"Uncertainties of slopes are taken from the scatter of the readings about their line or from the stated "
     "uncertainty, whichever is larger.",
     {"Die Unsicherheiten der Neigungen folgen aus der Streuung der Messwerte um ihre Gerade oder aus der angegebenen "
      "Unsicherheit; die größere gilt.",
      "斜率的不确定度取读数相对其直线的散差与所给不确定度中较大者。",
      "傾きの不確かさは、直線まわりの測定値のばらつきと記載された不確かさのうち大きい方によります。"}},
    {"No uncertainty of the reference square was stated (--u-square-urad): it counts as exact.",
     {"Es ist keine Unsicherheit des Winkelnormals angegeben (--u-square-urad): Es gilt als genau.",
      "未给出直角尺的不确定度（--u-square-urad）：视为准确。",
      "直角定規の不確かさの記載がありません（--u-square-urad）：正確とみなします。"}},
    // Engraved curves.
    {"Section {} is not evaluated: {w}.",
     {"Schnitt {0} ist nicht ausgewertet: {1}.", "截面 {0} 未评定：{1}。", "断面 {0} は評価されていません：{1}。"}},
    {"Contour error: from the commanded curve (origin of each section) to P2, where surface and wall would meet. The "
     "distance P1 P2, which Yin et al. call the contour error, is the rounding of the edge: it does not depend on "
     "where the edge is.",
     {"Konturabweichung: von der Sollkurve (Ursprung jedes Schnitts) bis P2, wo sich Fläche und Wand treffen würden. "
      "Der Abstand P1 P2, den Yin et al. Konturabweichung nennen, ist die Verrundung der Kante: Er hängt nicht davon "
      "ab, wo die Kante liegt.",
      "轮廓误差：从指令曲线（各截面的原点）到 P2，即表面与侧壁的延长线的交点。Yin "
      "等人称为轮廓误差的距离 P1 P2 是边缘的圆角：它与边缘的位置无关。",
      "輪郭誤差：指令曲線（各断面の原点）から、面と壁の延長が交わる P2 までの距離。Yin らが輪郭誤差と呼ぶ距離 P1 P2 "
      "は縁の丸みであり、縁の位置にはよりません。"}},
    {"The origins of the sections share a standard uncertainty of {} µm.",
     {"Die Ursprünge der Schnitte haben eine gemeinsame Standardunsicherheit von {0} µm.",
      "各截面的原点有共同的标准不确定度 {0} µm。", "各断面の原点には共通の標準不確かさ {0} µm があります。"}},
    {"No uncertainty of the sections' origins was stated (--u-origin-um): the figures hold only the scatter of the "
     "points.",
     {"Es ist keine Unsicherheit der Ursprünge der Schnitte angegeben (--u-origin-um): Die Kennwerte enthalten nur die "
      "Streuung der Punkte.",
      "未给出截面原点的不确定度（--u-origin-um）：各指标仅含点的散差。",
      "断面の原点の不確かさの記載がありません（--u-origin-um）：特性値は点のばらつきだけを含みます。"}},
    {"{} point lies beyond an end of the curve, without a part in the figures.",
     {"{0} Punkt liegt jenseits eines Endes der Kurve und geht nicht in die Kennwerte ein.",
      "{0} 个点位于曲线端点之外，不计入指标。", "{0} 点が曲線の端より外にあり、特性値に含まれません。"}},
    {"{} points lie beyond an end of the curve, without a part in the figures.",
     {"{0} Punkte liegen jenseits eines Endes der Kurve und gehen nicht in die Kennwerte ein.",
      "{0} 个点位于曲线端点之外，不计入指标。", "{0} 点が曲線の端より外にあり、特性値に含まれません。"}},
    {"{} point lies where the direction of the tool is that of the curve: nothing is across it there, and only the "
     "distances count.",
     {"{0} Punkt liegt dort, wo die Werkzeugrichtung die der Kurve ist: Dort gibt es keine Richtung quer zu ihr, und "
      "nur die Abstände zählen.",
      "{0} 个点处刀具方向与曲线方向相同：该处没有横向，仅计距离。",
      "{0} 点では工具の方向が曲線の方向と一致します：そこには横方向がなく、距離だけを用います。"}},
    {"{} points lie where the direction of the tool is that of the curve: nothing is across it there, and only the "
     "distances count.",
     {"{0} Punkte liegen dort, wo die Werkzeugrichtung die der Kurve ist: Dort gibt es keine Richtung quer zu ihr, und "
      "nur die Abstände zählen.",
      "{0} 个点处刀具方向与曲线方向相同：该处没有横向，仅计距离。",
      "{0} 点では工具の方向が曲線の方向と一致します：そこには横方向がなく、距離だけを用います。"}},
    {"Between its points the commanded curve is smooth (cubic pieces with the tangents of circles), except where its "
     "sides turn by more than 20 degrees.",
     {"Zwischen ihren Punkten ist die Sollkurve glatt (kubische Stücke mit den Tangenten von Kreisen), außer wo sich "
      "ihre Seiten um mehr als 20 Grad drehen.",
      "指令曲线在其各点之间是光滑的（三次曲线段，切线取自圆），相邻边转折超过 20 度处除外。",
      "指令曲線は点の間で滑らかです（円の接線をもつ三次曲線）。辺が 20 度を超えて折れる箇所を除きます。"}},
    {"Only the pieces on which the tool works are compared, each point with the one nearest to it; the length along "
     "the curve counts them one behind the other.",
     {"Verglichen werden nur die Stücke, auf denen das Werkzeug arbeitet, jeder Punkt mit dem nächsten Stück; die "
      "Länge "
      "entlang der Kurve zählt sie hintereinander.",
      "仅比较刀具加工的曲线段，每个点与离它最近的段比较；沿曲线的长度按各段依次累计。",
      "工具が加工する区間だけを、各点を最も近い区間と比較します。曲線に沿った長さは区間を順につないで数えます。"}},
    // Linkages.
    {"A zero error of A cannot be told from L_tA and R_A: an arcsecond of it looks like {} µm of L_tA.",
     {"Eine Nullpunktabweichung von A ist von L_tA und R_A nicht zu unterscheiden: Eine Bogensekunde davon wirkt wie "
      "{0} µm von L_tA.",
      "A 轴的零位误差无法与 L_tA 和 R_A 区分：1 角秒相当于 L_tA 的 {0} µm。",
      "A 軸の零点誤差は L_tA 及び R_A と区別できません：その 1 秒は L_tA の {0} µm に相当します。"}},
    {"Not stated, taken as exact: {}.",
     {"Nicht angegeben und als genau angenommen: {0}.", "未给出、视为准确：{0}。",
      "記載がなく、正確とみなしたもの：{0}。"}},
    // Thermal tests.
    {"No uncertainty of the readings was stated (--u-reading-um): ranges have no measurement uncertainty.",
     {"Es ist keine Unsicherheit der Messwerte angegeben (--u-reading-um): Die Spannen haben keine Messunsicherheit.",
      "未给出读数的不确定度（--u-reading-um）：变化范围没有测量不确定度。",
      "測定値の不確かさの記載がありません（--u-reading-um）：変動範囲には測定不確かさがありません。"}},
    {"Sensors in two planes show tilts if the distance of the planes is stated (--plane-distance-mm).",
     {"Aufnehmer in zwei Ebenen zeigen Neigungen, wenn der Abstand der Ebenen angegeben ist (--plane-distance-mm).",
      "给出两个平面的距离（--plane-distance-mm）后，两个平面内的传感器可显示倾斜。",
      "二平面の距離（--plane-distance-mm）を示せば、二平面の変位計から傾きが求まります。"}},
    {"{} was not read for {}: it is interpolated linearly in between.",
     {"{0} wurde {1} lang nicht abgelesen: Der Verlauf dazwischen gilt als gerade Linie.",
      "{0} 有 {1} 没有读数：其间的变化视为直线。",
      "{0} は {1} の間読み取られていません：その間の変化は直線とみなします。"}},
    {"U_L is that of a length that has been corrected for NDE; without the correction NDE is a systematic error.",
     {"U_L gilt für eine um NDE korrigierte Länge; ohne die Korrektur ist NDE eine systematische Abweichung.",
      "U_L 是经 NDE 修正的长度的不确定度；不修正时 NDE 为系统误差。",
      "U_L は NDE を補正した長さの不確かさです。補正しない場合、NDE は系統誤差です。"}},
    {"There is no temperature (NAME_degC): an ETVE holds for temperatures that change as they did in the test.",
     {"Es gibt keine Temperatur (NAME_degC): Eine ETVE gilt für Temperaturen, die sich wie bei der Prüfung ändern.",
      "没有温度（NAME_degC）：ETVE 仅适用于与检验时变化相同的温度。",
      "温度（NAME_degC）がありません：ETVE は試験時と同じように変化する温度に対して成り立ちます。"}},
    {"Uncertainties of time constants are those of the fit, from its residuals or from the stated uncertainty of a "
     "reading, whichever is larger.",
     {"Die Unsicherheiten der Zeitkonstanten sind die der Ausgleichung, aus ihren Residuen oder aus der angegebenen "
      "Unsicherheit eines Messwerts; der größere Wert gilt.",
      "时间常数的不确定度为拟合的不确定度，由残差或所给读数不确定度得出，取较大者。",
      "時定数の不確かさは当てはめの不確かさで、残差又は示された測定値の不確かさのうち大きい方によります。"}},
    {"The targets were not read over a common time: neither the change of their distance nor an expansion is known.",
     {"Die Zielpositionen wurden nicht im selben Zeitraum abgelesen: Die Änderung ihres Abstands ist nicht bekannt, "
      "auch keine Ausdehnung.",
      "各目标位置的读数不在同一时段：其距离的变化未知，膨胀亦未知。",
      "各目標位置が同じ期間に読み取られていません：距離の変化も膨張も分かりません。"}},
};

constexpr NoteWord kNoteArguments[] = {
    {"clockwise", {"im Uhrzeigersinn", "顺时针", "時計回り"}},
    {"counter-clockwise", {"gegen den Uhrzeigersinn", "逆时针", "反時計回り"}},
    {"radial along X, plane 1", {"radial in X, Ebene 1", "沿 X 径向，平面 1", "X 方向半径、平面 1"}},
    {"radial along Y, plane 1", {"radial in Y, Ebene 1", "沿 Y 径向，平面 1", "Y 方向半径、平面 1"}},
    {"radial, rotating direction, plane 1",
     {"radial, umlaufende Richtung, Ebene 1", "径向，旋转方向，平面 1", "半径、回転方向、平面 1"}},
    {"radial along X, plane 2", {"radial in X, Ebene 2", "沿 X 径向，平面 2", "X 方向半径、平面 2"}},
    {"radial along Y, plane 2", {"radial in Y, Ebene 2", "沿 Y 径向，平面 2", "Y 方向半径、平面 2"}},
    {"radial, rotating direction, plane 2",
     {"radial, umlaufende Richtung, Ebene 2", "径向，旋转方向，平面 2", "半径、回転方向、平面 2"}},
    {"tilt towards X", {"Kippung nach X", "向 X 倾斜", "X 方向への傾斜"}},
    {"tilt towards Y", {"Kippung nach Y", "向 Y 倾斜", "Y 方向への傾斜"}},
    {"tilt, rotating direction", {"Kippung, umlaufende Richtung", "倾斜，旋转方向", "傾斜、回転方向"}},
    {"axial", {"axial", "轴向", "軸方向"}},
    {"face", {"Planseite", "端面", "端面"}},
    // Why a figure is not evaluated.
    {"not driven", {"nicht gefahren", "未运行", "実施していません"}},
    {"the readings last less than an hour",
     {"die Messung dauert weniger als eine Stunde", "读数持续不足一小时", "測定は 1 時間未満です"}},
    {"there is no reading for more than half an hour",
     {"mehr als eine halbe Stunde lang fehlen Messwerte", "有超过半小时没有读数", "30 分を超えて測定値がありません"}},
    {"too few readings that are independent of each other",
     {"zu wenige voneinander unabhängige Messwerte", "相互独立的读数过少", "互いに独立な測定値が少なすぎます"}},
    {"no change beyond the scatter of the readings",
     {"keine Änderung über die Streuung der Messwerte hinaus", "变化不超过读数的分散",
      "測定値のばらつきを超える変化がありません"}},
    {"the readings do not follow a first-order response",
     {"die Messwerte folgen keinem Verzögerungsglied erster Ordnung", "读数不符合一阶响应",
      "測定値は一次遅れの応答に従いません"}},
    {"the readings do not bound it: they end too early or are too far apart",
     {"die Messwerte begrenzen sie nicht: sie enden zu früh oder liegen zu weit auseinander",
      "读数不能限定其值：结束过早或间隔过大", "測定値では定まりません：終わりが早すぎるか間隔が大きすぎます"}},
    {"fewer than three readings", {"weniger als drei Messwerte", "少于三个读数", "測定値が 3 個未満です"}},
    {"the arc is shorter than 200° and has no centre of its own; --centre instrument takes the instrument's",
     {"der Bogen ist kürzer als 200° und hat keinen eigenen Mittelpunkt; --centre instrument nimmt den des Messgeräts",
      "圆弧小于 200°，没有自身的圆心；--centre instrument 采用仪器的圆心",
      "円弧が 200° より短く固有の中心がありません；--centre instrument は測定器の中心を用います"}},
    {"the readings are not a circle around the instrument",
     {"die Messwerte bilden keinen Kreis um das Messgerät", "读数不是绕仪器的圆",
      "測定値が測定器を中心とする円ではありません"}},
    {"a path has no least-squares circle",
     {"eine Bahn hat keinen Ausgleichskreis", "某一轨迹没有最小二乘圆", "最小二乗円のない経路があります"}},
    {"too few readings", {"zu wenige Messwerte", "读数过少", "測定値が少なすぎます"}},
    {"the length is not calibrated", {"die Länge ist nicht kalibriert", "长度未校准", "長さが校正されていません"}},
    {"these readings do not separate it from the other causes",
     {"mit diesen Messwerten nicht von den anderen Ursachen zu unterscheiden", "由这些读数无法与其他原因区分",
      "これらの測定値では他の原因と区別できません"}},
    {"not run", {"nicht ausgeführt", "未执行", "実行していません"}},
    {"fewer than {} whole turns", {"weniger als {0} ganze Umdrehungen", "少于 {0} 整圈", "{0} 回転未満です"}},
    {"fewer than {} readings per turn",
     {"weniger als {0} Messwerte je Umdrehung", "每圈读数少于 {0} 个", "1 回転当たりの測定値が {0} 個未満です"}},
    {"a step of the angle is more than {} times the mean step",
     {"ein Winkelschritt ist größer als das {0}-Fache des mittleren", "某一角度步距大于平均步距的 {0} 倍",
      "平均の {0} 倍を超える角度間隔があります"}},
    {"there is no probe", {"es gibt keinen Aufnehmer", "没有传感器", "変位計がありません"}},
    {"no section could be evaluated",
     {"kein Schnitt konnte ausgewertet werden", "没有可评定的截面", "評価できる断面がありません"}},
    {"{} of {} sections could not be evaluated",
     {"{0} von {1} Schnitten konnten nicht ausgewertet werden", "{1} 个截面中有 {0} 个无法评定",
      "{1} 断面のうち {0} 断面を評価できません"}},
    {"no point lies beside the curve",
     {"kein Punkt liegt neben der Kurve", "没有位于曲线旁的点", "曲線のそばに点がありません"}},
    {"one section", {"nur ein Schnitt", "仅一个截面", "1 断面だけです"}},
    {"left edge: {w}", {"linke Kante: {0}", "左边缘：{0}", "左の縁：{0}"}},
    {"right edge: {w}", {"rechte Kante: {0}", "右边缘：{0}", "右の縁：{0}"}},
    {"fewer than 20 points", {"weniger als 20 Punkte", "少于 20 个点", "点が 20 個未満です"}},
    {"the outer quarter of the section is not a line: {*}",
     {"das äußere Viertel des Schnitts ist keine Gerade: {0}", "截面外侧四分之一不是直线：{0}",
      "断面の外側 4 分の 1 が直線ではありません：{0}"}},
    {"the outer quarter of the section is inclined by more than 30 degrees",
     {"das äußere Viertel des Schnitts ist um mehr als 30 Grad geneigt", "截面外侧四分之一的倾斜超过 30 度",
      "断面の外側 4 分の 1 が 30 度を超えて傾いています"}},
    {"nothing is deeper than eight times the scatter of the surface",
     {"nichts ist tiefer als das Achtfache der Streuung der Fläche", "没有深于表面散差八倍之处",
      "面のばらつきの 8 倍より深い箇所がありません"}},
    {"no three points in a row below half of the depth",
     {"keine drei Punkte nacheinander unter der halben Tiefe", "没有连续三个点低于半深",
      "半分の深さより下に連続した 3 点がありません"}},
    {"coordinates that are not finite",
     {"Koordinaten, die nicht endlich sind", "坐标不是有限值", "有限でない座標があります"}},
    {"the fit of the corner of the section did not converge",
     {"die Ecke des Schnitts kam nicht zur Ruhe", "截面的拐角未收敛", "断面の角が収束しません"}},
    {"neither the wall nor four points of the rounding are seen",
     {"weder die Wand noch vier Punkte der Verrundung sind zu sehen", "既看不到侧壁，也看不到圆角上的四个点",
      "壁も丸みの 4 点も見えません"}},
    {"the wall is not seen, and of the rounding less than 45 degrees",
     {"die Wand ist nicht zu sehen und von der Verrundung weniger als 45 Grad", "看不到侧壁，且圆角可见部分小于 45 度",
      "壁が見えず、丸みは 45 度未満しか見えません"}},
    {"no more points on the curve than it has unknowns",
     {"nicht mehr Punkte auf der Kurve, als sie Unbekannte hat", "曲线上的点数不多于其未知数",
      "曲線上の点が未知数より多くありません"}},
    {"the points do not separate corner, radius and wall",
     {"die Punkte trennen Ecke, Radius und Wand nicht", "这些点无法区分拐角、半径和侧壁",
      "点では角、半径及び壁を区別できません"}},
    // Poses and ranges.
    {"{} poses over {*}", {"{0} Posen über {1}", "{1} 内的 {0} 个位姿", "{1} の {0} 個の姿勢"}},
    {"{} {} to {} mm", {"{0} {1} bis {2} mm", "{0} {1} 至 {2} mm", "{0} {1} ～ {2} mm"}},
    {"{} {} to {} deg", {"{0} {1} bis {2}°", "{0} {1} 至 {2}°", "{0} {1} ～ {2}°"}},
    {"{} to {} mm", {"{0} bis {1} mm", "{0} 至 {1} mm", "{0} ～ {1} mm"}},
    {"{} {} mm", {"{0} {1} mm", "{0} {1} mm", "{0} {1} mm"}},
    {"{} {} deg", {"{0} {1}°", "{0} {1}°", "{0} {1}°"}},
    {"{} lies outside the range in which the errors are known",
     {"{0} liegt außerhalb des Bereichs, in dem die Abweichungen bekannt sind", "{0} 个位于误差已知的范围之外",
      "{0} 姿勢は誤差が既知の範囲の外"}},
    {"{} lie outside the range in which the errors are known",
     {"{0} liegen außerhalb des Bereichs, in dem die Abweichungen bekannt sind", "{0} 个位于误差已知的范围之外",
      "{0} 姿勢は誤差が既知の範囲の外"}},
    {"{} needs corrected commands outside the travel",
     {"{0} braucht korrigierte Befehle außerhalb des Verfahrwegs", "{0} 个的补偿指令超出行程",
      "{0} 姿勢は補正指令が移動範囲を超過"}},
    {"{} need corrected commands outside the travel",
     {"{0} brauchen korrigierte Befehle außerhalb des Verfahrwegs", "{0} 个的补偿指令超出行程",
      "{0} 姿勢は補正指令が移動範囲を超過"}},
    {"{} cannot be reached with the axes that are corrected",
     {"{0} nicht zu erreichen mit den korrigierten Achsen", "{0} 个用参与补偿的轴无法到达",
      "{0} 姿勢は補正する軸では到達不可"}},
    // What an uncertainty is of.
    {"identified errors only", {"nur ermittelte Abweichungen", "仅含已辨识误差", "同定した誤差のみ"}},
    {"directions that the readings determine only",
     {"nur Richtungen, die die Messwerte bestimmen", "仅含读数能确定的方向", "測定値で定まる方向のみ"}},
    {"all six error motions of {}",
     {"alle sechs Bewegungsabweichungen von {0}", "{0} 轴的全部六项误差运动", "{0} 軸の六つの誤差運動すべて"}},
    // Why a result is not trusted.
    {"the residuals are {} times as large as the stated uncertainties of the readings explain (chi-square {} with {} "
     "degrees of freedom, probability below {}): the model lacks errors that the readings show, a number of the set-up "
     "or of the machine is wrong, or the readings are less certain than stated. The stated uncertainties of the result "
     "are too small",
     {"Die Residuen sind {0}-mal so groß, wie es die angegebenen Unsicherheiten der Messwerte erklären (Chi-Quadrat "
      "{1} mit {2} Freiheitsgraden, Wahrscheinlichkeit unter {3}): Dem Modell fehlen Abweichungen, die die Messwerte "
      "zeigen, eine Zahl des Aufbaus oder der Maschine ist falsch, oder die Messwerte sind unsicherer als angegeben. "
      "Die angegebenen Unsicherheiten des Ergebnisses sind zu klein",
      "残差为读数所给不确定度所能解释的 {0} 倍（卡方 {1}，自由度 {2}，概率低于 "
      "{3}）：模型缺少读数所显示的误差，安装或机床的某个数值有误，或读数的不确定度大于所给值。结果所给的不确定度偏小",
      "残差は記載された測定値の不確かさで説明できる大きさの {0} 倍です（カイ二乗 {1}、自由度 {2}、確率 {3} "
      "未満）：測定値に現れた誤差がモデルにないか、設置若しくは機械の数値が誤っているか、測定値が記載より不確かです。"
      "結果に記載された不確かさは小さすぎます"}},
    {"at poses that were not used in the fit, the root mean square error is {} um after the correction and {} um "
     "before, which neither noise nor the uncertainty of the identified errors explains (probability below {}): the "
     "identified errors make the machine worse",
     {"an Posen, die nicht in die Ausgleichung eingingen, beträgt die Abweichung (quadratisches Mittel) {0} µm nach "
      "der "
      "Korrektur und {1} µm davor, was weder Rauschen noch die Unsicherheit der ermittelten Abweichungen erklärt "
      "(Wahrscheinlichkeit unter {2}): Die ermittelten Abweichungen verschlechtern die Maschine",
      "在未参与拟合的位姿上，误差的均方根补偿后为 {0} µm，补偿前为 {1} "
      "µm，噪声和已辨识误差的不确定度均无法解释（概率低于 {2}）：已辨识误差使机床变差",
      "当てはめに用いなかった姿勢での誤差の二乗平均平方根は補正後 {0} µm、補正前 {1} "
      "µm で、雑音でも同定した誤差の不確かさでも説明できません（確率 {2} "
      "未満）：同定した誤差は機械を悪化させます"}},
    {"at poses that were not used in the fit, the root mean square error is {} um after the correction and {} um "
     "before, so the correction shows no improvement. Noise and the uncertainty of the identified errors may explain "
     "that, as on a machine whose errors are smaller than these",
     {"an Posen, die nicht in die Ausgleichung eingingen, beträgt die Abweichung (quadratisches Mittel) {0} µm nach "
      "der "
      "Korrektur und {1} µm davor; die Korrektur bringt also keine Verbesserung. Rauschen und die Unsicherheit der "
      "ermittelten Abweichungen können das erklären, etwa bei einer Maschine mit kleineren Abweichungen als diesen",
      "在未参与拟合的位姿上，误差的均方根补偿后为 {0} µm，补偿前为 {1} "
      "µm，即补偿未带来改善。噪声和已辨识误差的不确定度可能是其原因，例如机床误差小于它们时",
      "当てはめに用いなかった姿勢での誤差の二乗平均平方根は補正後 {0} µm、補正前 {1} "
      "µm で、補正による改善は見られません。機械の誤差がこれらより小さい場合など、雑音と同定した誤差の不確かさによるも"
      "のと考えられます"}},
    {"{} is on average {} {}, beyond the {} {} that a machine in use may have: an axis, its direction or point, a unit "
     "or a number of the set-up is probably wrong in the input",
     {"{0} ist im Mittel {1} {2}, mehr als die {3} {4}, die eine Maschine im Einsatz haben kann: Wahrscheinlich ist in "
      "den Eingaben eine Achse, ihre Richtung oder ihr Punkt, eine Einheit oder eine Zahl des Aufbaus falsch",
      "{0} 平均为 {1} {2}，超过在用机床可能有的 {3} {4}：输入中某一轴线、其方向或其上的点、单位或安装数值可能有误",
      "{0} は平均 {1} {2} で、使用中の機械にあり得る {3} {4} "
      "を超えます：入力の軸、その方向若しくは点、単位又は設置の数値に誤りがあると思われます"}},
    {"{} varies about its mean by {} {}, beyond the {} {} that a machine in use may have: an axis, its direction or "
     "point, a unit or a number of the set-up is probably wrong in the input",
     {"{0} schwankt um sein Mittel um {1} {2}, mehr als die {3} {4}, die eine Maschine im Einsatz haben kann: "
      "Wahrscheinlich ist in den Eingaben eine Achse, ihre Richtung oder ihr Punkt, eine Einheit oder eine Zahl des "
      "Aufbaus falsch",
      "{0} 在其平均值上下变化 {1} {2}，超过在用机床可能有的 {3} "
      "{4}：输入中某一轴线、其方向或其上的点、单位或安装数值可能有误",
      "{0} は平均のまわりに {1} {2} 変動し、使用中の機械にあり得る {3} {4} "
      "を超えます：入力の軸、その方向若しくは点、単位又は設置の数値に誤りがあると思われます"}},
    {"{} is {} {}, beyond the {} {} that a machine in use may have: an axis, its direction or point, a unit or a "
     "number "
     "of the set-up is probably wrong in the input",
     {"{0} ist {1} {2}, mehr als die {3} {4}, die eine Maschine im Einsatz haben kann: Wahrscheinlich ist in den "
      "Eingaben eine Achse, ihre Richtung oder ihr Punkt, eine Einheit oder eine Zahl des Aufbaus falsch",
      "{0} 为 {1} {2}，超过在用机床可能有的 {3} {4}：输入中某一轴线、其方向或其上的点、单位或安装数值可能有误",
      "{0} は {1} {2} で、使用中の機械にあり得る {3} {4} "
      "を超えます：入力の軸、その方向若しくは点、単位又は設置の数値に誤りがあると思われます"}},
    {"{} of the {} readings {} are outliers, {} of the {} others: the robust loss leaves a whole region out, of which "
     "the result says nothing",
     {"{0} der {1} Messwerte ({2}) sind Ausreißer, {3} der {4} anderen: Die robuste Verlustfunktion lässt einen ganzen "
      "Bereich weg, über den das Ergebnis nichts sagt",
      "{1} 个读数（{2}）中有 {0} 个异常值，其余 {4} 个中有 {3} 个：稳健损失函数舍去了整个区域，结果对其无说明",
      "測定値 {1} 個（{2}）のうち {0} 個、他の {4} 個のうち {3} "
      "個が外れ値です：ロバスト損失関数が一つの領域全体を除外しており、結果はそこについて何も示しません"}},
    {"{} of the {} readings {} are outliers, {} of the {} others",
     {"{0} der {1} Messwerte ({2}) sind Ausreißer, {3} der {4} anderen",
      "{1} 个读数（{2}）中有 {0} 个异常值，其余 {4} 个中有 {3} 个",
      "測定値 {1} 個（{2}）のうち {0} 個、他の {4} 個のうち {3} 個が外れ値"}},
    {"misfit", {"Messwerte passen nicht zum Modell", "读数与模型不符", "測定値がモデルに合いません"}},
    {"worse held out", {"an zurückgehaltenen Messwerten schlechter", "对留出读数更差", "未使用の測定値で悪化"}},
    {"no improvement", {"keine Verbesserung", "没有改善", "改善なし"}},
    {"implausible size", {"unplausible Größe", "量值不合理", "大きさが不合理"}},
    {"region left out", {"ein Bereich bleibt unberücksichtigt", "遗漏某一区域", "除外された領域あり"}},
    // Conventions.
    {"{} keeps its start value", {"{0} behält seinen Startwert", "{0} 保持其初始值", "{0} は初期値のまま"}},
    {"the slope of the reference straight line of {} is zero",
     {"die Neigung der Bezugsgeraden von {0} ist null", "{0} 参考直线的斜率为零", "{0} の基準直線の傾きは零"}},
    {"the mean of {} over the range is zero",
     {"das Mittel von {0} über dem Bereich ist null", "{0} 在范围内的平均值为零", "範囲における {0} の平均は零"}},
    {"the {} is zero", {"{0} ist null", "{0} 为零", "{0} は零"}},
};

}  // namespace

std::span<const NoteWord> evaluation_note_words() { return kEvaluationNotes; }
std::span<const NoteWord> note_argument_words() { return kNoteArguments; }

}  // namespace abbe
