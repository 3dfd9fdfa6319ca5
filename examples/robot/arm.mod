MODULE Arm
  ! Joint positions, and Cartesian positions in the base of the arm with the flange as the tool.
  CONST jointtarget home := [[0, -20, 30, 0, 60, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
  CONST robtarget p10:=[[238.198,98.022,687.212],[0.257834160,-0.294496677,0.916817236,0.078989928],[0,0,-1,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  PERS robtarget p{2} := [
    [[346.826, -322.327, 589.372], [0.142959162, 0.704906380, 0.541878331, -0.434784484], [-1, -1, 1, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]],
    [[168.715, 235.655, 585.568], [0.558118094, -0.010837707, 0.701847585, 0.442489215], [0, 0, 0, 1], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]]
  ];

  PROC main()
    MoveAbsJ home, v500, fine, tool0;
    MoveJ p10, v500, z10, tool0;
    MoveL p{1}, v200, fine, tool0;
    MoveL Offs(p{2}, 0, 0, 10), v200, fine, tool0;
  ENDPROC
ENDMODULE
