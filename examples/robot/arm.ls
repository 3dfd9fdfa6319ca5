/PROG  ARM
/ATTR
COMMENT		= "six-axis arm";
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
   1:  UFRAME_NUM=0 ;
   2:  UTOOL_NUM=1 ;
   3:J P[1] 100% FINE    ;
   4:J P[2:"first"] 50% CNT10    ;
   5:L P[3] 200mm/sec FINE    ;
/POS
P[1]{
   GP1:
	UF : 0, UT : 1,	
	J1=     0.000 deg,	J2=   -20.000 deg,	J3=    30.000 deg,
	J4=     0.000 deg,	J5=    60.000 deg,	J6=     0.000 deg
};
P[2:"first"]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =   238.198  mm,	Y =    98.022  mm,	Z =   687.212  mm,
	W =  -179.529 deg,	P =    31.285 deg,	R =  -144.252 deg
};
P[3]{
   GP1:
	UF : 0, UT : 1,		CONFIG : 'N U T, 0, 0, 0',
	X =   346.826  mm,	Y =  -322.327  mm,	Z =   589.372  mm,
	W =  -155.105 deg,	P =    50.165 deg,	R =    86.898 deg
};
/END
